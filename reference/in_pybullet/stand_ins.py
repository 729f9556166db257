"""What stands in for shapes and limits that Bullet does not have."""

import math

WIDEST = math.radians(85.0)
"""Widest swing limit [rad] that Bullet gets. Wider: a limb at 90 degrees about y is at 0 or 180 degrees about x, and is thrown by
the second; smaller: more joints are without a limit of their swing."""
