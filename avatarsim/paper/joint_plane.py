"""Angle of one CCD step (Schmidl and Lin 2004, eqs 4 and 5): effector and goal projected into the plane of a joint."""

from math import atan2

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, sub

ON_AXIS = 1e-9
"""Relative to the longer of the two arms: an effector or a goal nearer than this to the joint's axis has no direction in
the joint's plane. Larger: hands close to an axis are not turned; smaller: rounding decides which way they turn."""


@kernel
def projected(p: Vec3, origin: Vec3, axis: Vec3) -> Vec3:
    """Eq. (4): p' = p - (a_h . (p - o_h)) a_h, with o_h ``origin`` [m] and a_h ``axis``, a unit vector.

    (The printed equation calls the axis n in one of its two places.)
    """
    return along(p, -dot(axis, sub(p, origin)), axis)


@kernel
def joint_turn(origin: Vec3, axis: Vec3, effector: Vec3, goal: Vec3) -> float:
    """Eq. (5): angle phi_h [rad], in [-pi, pi], about ``axis`` that brings the effector nearest to the goal.

    The printed acos has no sign, and wants unit vectors from the joint's origin. Here phi = atan2(a . (e x g), e . g) of the
    projected arms e and g. 0 if either has no direction in the joint's plane: then no turn of this joint brings them closer.
    """
    e = sub(projected(effector, origin, axis), origin)
    g = sub(projected(goal, origin, axis), origin)
    to_e, to_g = sub(effector, origin), sub(goal, origin)
    least = ON_AXIS * ON_AXIS * max(dot(to_e, to_e), dot(to_g, to_g))
    if not (dot(e, e) > least and dot(g, g) > least):
        return 0.0
    return atan2(dot(axis, cross(e, g)), dot(e, g))
