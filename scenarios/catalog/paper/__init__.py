"""Figures, tables and special cases of the paper, as scenes."""
