"""Robustness: hard cases under changes that should not matter: start, seed, frame time, size, place. What survives and spreads."""
