"""Figures, tables and special cases of the paper, as scenes."""

TABLE_2 = ("two_arms", "self_collision", "two_arms_and_leg", "arm_in_corner")
"""The scenes of Table 2 in its order, the cheapest first."""
