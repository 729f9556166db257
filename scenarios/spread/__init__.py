"""Sensitivity to the order in which chains are treated: one scene and motion, a hundred orders, and how far the frames spread."""
