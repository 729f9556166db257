"""What stands in for shapes that Bullet does not have."""

ELLIPSOID_VERTICES = 162
"""Vertices of the hull that stands for an ellipsoid: it lies inside by at most about 2 % of the largest radius."""
