"""Vectors, rotations and poses; knows nothing of contact or time."""
