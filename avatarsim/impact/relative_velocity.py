"""Relative velocity at a contact (eq. 7) and its normal part after an impact (eq. 8, Newton's law of restitution)."""

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, sub


@kernel
def point_velocity(linear: Vec3, angular: Vec3, arm: Vec3) -> Vec3:
    """Velocity [m/s] of the point of a rigid body at ``arm`` [m] from its centre of mass."""
    return add(linear, cross(angular, arm))


@kernel
def relative_velocity(velocity_a: Vec3, velocity_b: Vec3) -> Vec3:
    """v_ab [m/s]: velocity of A's contact point as seen from B's."""
    return sub(velocity_a, velocity_b)


@kernel
def normal_velocity(n: Vec3, v_ab: Vec3) -> float:
    """Eq. 7: v_n = n . v_ab [m/s], n out of B into A; negative while the bodies approach."""
    return dot(n, v_ab)


@kernel
def tangential_velocity(n: Vec3, v_ab: Vec3) -> Vec3:
    """v_t of eq. 10 [m/s]: what is left of v_ab without its part along n."""
    return along(v_ab, -dot(n, v_ab), n)


@kernel
def velocity_after(restitution: float, before: float) -> float:
    """Eq. 8: v+ = -e v- [m/s]."""
    return -restitution * before
