"""Sliding, rolling and tipping under Coulomb friction."""
