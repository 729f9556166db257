"""Velocities after one impact, by conservation of momentum and Newton's restitution."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def two_spheres(mass_a: float, mass_b: float, speed_a: float, speed_b: float, restitution: float) -> tuple[float, float]:
    """Velocities [m/s] after a central impact: both get the common velocity, less e times what they had against it."""
    common = (mass_a * speed_a + mass_b * speed_b) / (mass_a + mass_b)
    return (
        common - restitution * mass_b * (speed_a - speed_b) / (mass_a + mass_b),
        common + restitution * mass_a * (speed_a - speed_b) / (mass_a + mass_b),
    )


def superball_speed(light: float, heavy: float, speed: float) -> float:
    """Speed [m/s] of a light ball on a heavy one, both dropped at `speed`, all impacts elastic: (3 M - m) / (M + m) v."""
    return (3.0 * heavy - light) / (heavy + light) * speed


def cradle_velocities(balls: int, speed: float) -> tuple[float, ...]:
    """Velocities [m/s] of equal elastic balls in a row with gaps after the first came in at `speed`: the last takes all."""
    return (*(0.0 for _ in range(balls - 1)), speed)


@dataclass(frozen=True)
class Oblique:
    """Sphere after an oblique impact: `normal` velocity away from the wall and `tangential` velocity of the centre
    [m/s], `spin` [rad/s] that rolls along with the tangential motion, and whether the contact `sticks`."""

    normal: float
    tangential: float
    spin: float
    sticks: bool


def oblique_bounce(approach: float, tangential: float, friction: float, restitution: float, radius: float) -> Oblique:
    """A solid sphere without spin hits a fixed wall at `approach` > 0 and `tangential` >= 0 [m/s], `radius` [m].

    Friction stops the slip if mu (1 + e) v_n >= 2/7 v_t, and then v_t' = 5/7 v_t; else v_t' = v_t - mu (1 + e) v_n.
    """
    slide = friction * (1.0 + restitution) * approach
    sticks = slide >= 2.0 / 7.0 * tangential
    lost = 2.0 / 7.0 * tangential if sticks else slide
    return Oblique(restitution * approach, tangential - lost, 2.5 * lost / radius, sticks)


def oblique_bounce_literal(approach: float, tangential: float, friction: float, restitution: float, radius: float) -> Oblique:
    """The same with eq. 10 as printed, which has no clamp: the friction impulse is mu j even if that reverses the slip."""
    lost = friction * (1.0 + restitution) * approach
    return Oblique(restitution * approach, tangential - lost, 2.5 * lost / radius, False)


def point_impact(mass: float, inertia: ArrayLike, velocity: ArrayLike, spin: ArrayLike, arm: ArrayLike, normal: ArrayLike,
                 restitution: float) -> tuple[float, Array, Array]:
    """Eq. 9 against a fixed world: impulse j [N s], velocity [m/s] and angular velocity [rad/s] after.

    inertia (3, 3) about the centre of mass, world axes [kg m^2]; `arm` (3,) [m] from that centre to the contact;
    unit `normal` (3,) out of the world into the body. A contact that separates gets no impulse.
    """
    v, w, r, n = (np.asarray(x, dtype=np.float64) for x in (velocity, spin, arm, normal))
    approach = float(n @ (v + np.cross(w, r)))
    turned = np.linalg.solve(np.asarray(inertia, dtype=np.float64), np.cross(r, n))
    j = max(0.0, -(1.0 + restitution) * approach / (1.0 / mass + float(n @ np.cross(turned, r))))
    return j, v + j / mass * n, w + j * turned
