"""Coulomb friction (eq. 10): as printed, limited to the impulse that ends the slip, kinetic, and as a disc of contact forces."""

from math import sqrt

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, norm, scale

NO_SLIP = 1e-300
"""Below this speed [m/s] there is no direction to oppose; dividing by it would give inf or nan."""


@kernel
def friction_impulse(friction: float, j: float, v_t: Vec3) -> Vec3:
    """Eq. 10 as printed: j_t = -mu j v_t / |v_t| [N s], on A; zero without slip.

    Unlimited: with a light enough slip it reverses v_t and may add energy. `limited_friction_impulse` does not.
    """
    slip = norm(v_t)
    return scale(v_t, -friction * j / slip) if slip > NO_SLIP else (0.0, 0.0, 0.0)


@kernel
def limited_friction_impulse(friction: float, j: float, v_t: Vec3, sticking: float) -> Vec3:
    """Eq. 10 limited to ``sticking`` [N s], the size of the impulse that just ends the slip; also along -v_t."""
    slip = norm(v_t)
    return scale(v_t, -min(friction * j, sticking) / slip) if slip > NO_SLIP else (0.0, 0.0, 0.0)


@kernel
def kinetic_friction(friction: float, j: float, slip_x: float, slip_y: float, slip: float) -> tuple[float, float]:
    """Friction [N s] along both tangents under the normal impulse j [N s], against a slip of that velocity and size [m/s]."""
    pull = friction * j / slip
    return -pull * slip_x, -pull * slip_y


@kernel
def in_friction_disc(x: float, y: float, most: float) -> tuple[float, float]:
    """The nearest friction impulse to (x, y) [N s] that is at most ``most`` = mu times the normal impulse: Coulomb's disc."""
    square = x * x + y * y
    if square > most * most:
        share = most / sqrt(square)
        return x * share, y * share
    return x, y
