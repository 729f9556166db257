"""The judge of overlap, what it is made of, and what it is judged by."""
