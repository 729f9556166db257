"""The judge of overlap, its parts, and the exact cases that it is checked with."""
