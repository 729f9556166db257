"""Robustness of hard cases to changes that should not matter: start, seed, frame time, size, place; what survives and spreads."""
