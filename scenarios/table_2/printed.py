"""The scenes of the paper's Table 2."""

SCENES = ("two_arms", "self_collision", "two_arms_and_leg", "arm_in_corner")
"""In its order, the cheapest first."""
