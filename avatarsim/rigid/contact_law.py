"""Contact law: Newton's law of restitution (eqs 7 to 9) and Coulomb friction (eq. 10) of Schmidl and Lin 2004.

Friction comes in four forms: as printed, limited to the impulse that ends the slip, kinetic, and as a disc of contact forces.
"""

from math import sqrt

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import Columns, turned
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, scale, sub

# Relative velocity at a contact (eq. 7) and its normal part after an impact (eq. 8).


@kernel
def point_velocity(linear: Vec3, angular: Vec3, arm: Vec3) -> Vec3:
    """Return the velocity [m/s] of the point of a rigid body at ``arm`` [m] from its centre of mass."""
    return add(linear, cross(angular, arm))


@kernel
def relative_velocity(velocity_a: Vec3, velocity_b: Vec3) -> Vec3:
    """Return v_ab [m/s]: velocity of A's contact point as seen from B's."""
    return sub(velocity_a, velocity_b)


@kernel
def normal_velocity(n: Vec3, v_ab: Vec3) -> float:
    """Return v_n = n . v_ab [m/s] (eq. 7), n out of B into A; negative while the bodies approach."""
    return dot(n, v_ab)


@kernel
def tangential_velocity(n: Vec3, v_ab: Vec3) -> Vec3:
    """Return v_t of eq. 10 [m/s]: v_ab without its part along n."""
    return along(v_ab, -dot(n, v_ab), n)


@kernel
def velocity_after(restitution: float, before: float) -> float:
    """Return v+ = -e v- [m/s] (eq. 8)."""
    return -restitution * before


# Normal impulse of a collision with restitution (eq. 9).


@kernel
def turning_term(inverse_inertia: Columns, arm: Vec3, n: Vec3) -> float:
    """Return A or B of eq. 9 [1/kg]: n . ((I^-1 (r x n)) x r), the rotational part of the inverse effective mass.

    ``inverse_inertia`` is in world axes; all zero for a body that cannot turn.
    """
    return dot(n, cross(turned(inverse_inertia, cross(arm, n)), arm))


@kernel
def collision_impulse(
    restitution: float, before: float, inverse_mass_a: float, inverse_mass_b: float, turning_a: float, turning_b: float
) -> float:
    """Return j = -(1 + e) v- / (1/m_b + 1/m_a + A + B) [N s] (eq. 9); j n acts on A and -j n on B.

    Not finite if neither body can yield; such pairs are never tested.
    """
    return -(1.0 + restitution) * before / (inverse_mass_b + inverse_mass_a + turning_a + turning_b)


# Coulomb friction (eq. 10).

NO_SLIP = 1e-300
"""Below this speed [m/s] there is no direction to oppose; dividing by it would give inf or nan."""


@kernel
def friction_impulse(friction: float, j: float, v_t: Vec3) -> Vec3:
    """Return j_t = -mu j v_t / |v_t| [N s] on A (eq. 10 as printed); zero without slip.

    Unlimited: with a light enough slip it reverses v_t and may add energy. `limited_friction_impulse` does not.
    """
    slip = norm(v_t)
    return scale(v_t, -friction * j / slip) if slip > NO_SLIP else (0.0, 0.0, 0.0)


@kernel
def limited_friction_impulse(friction: float, j: float, v_t: Vec3, sticking: float) -> Vec3:
    """Return the impulse of eq. 10 limited to ``sticking`` [N s], the size of the impulse that just ends the slip; along -v_t."""
    slip = norm(v_t)
    return scale(v_t, -min(friction * j, sticking) / slip) if slip > NO_SLIP else (0.0, 0.0, 0.0)


@kernel
def kinetic_friction(friction: float, j: float, slip_x: float, slip_y: float, slip: float) -> tuple[float, float]:
    """Return friction [N s] along both tangents by the normal impulse j [N s], against a slip of that velocity and size [m/s]."""
    ratio = friction * j / slip
    return -ratio * slip_x, -ratio * slip_y


@kernel
def in_friction_disc(x: float, y: float, most: float) -> tuple[float, float]:
    """Return the nearest friction impulse to (x, y) [N s] that is at most ``most`` = mu times the normal impulse: Coulomb's disc.

    With an infinite mu all impulses are in it, also without a normal impulse.
    """
    square = x * x + y * y
    if square > most * most:
        share = most / sqrt(square)
        return x * share, y * share
    return x, y
