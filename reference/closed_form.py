"""Exact answers that outrank every engine: falls and bounces, impacts, friction on planes, free rotation, springs.

SI units, g positive and pulling down; heights are those of a ball's lowest point above the floor. Callers pass valid numbers:
nothing is checked beyond the formula's own domain.
"""

from dataclasses import dataclass
from math import asin, cos, cosh, exp, floor, inf, log, pi, sin, sinh, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import quad
from scipy.special import ellipk, ellipkinc

Array = NDArray[np.float64]
Triple = tuple[float, float, float]


def fall_height(height: float, velocity: float, gravity: float, time: float) -> float:
    """Return the height [m] after `time` [s] of free fall from `height` [m] with upward `velocity` [m/s]: h + v t - g t^2 / 2."""
    return height + velocity * time - 0.5 * gravity * time * time


def fall_velocity(velocity: float, gravity: float, time: float) -> float:
    """Return the upward velocity [m/s] after `time` [s] of free fall: v - g t."""
    return velocity - gravity * time


def impact_speed(height: float, gravity: float) -> float:
    """Return the speed [m/s] at the floor after a drop from rest at `height` [m]: sqrt(2 g h)."""
    return sqrt(2.0 * gravity * height)


def bounce_time(height: float, restitution: float, gravity: float, bounce: int) -> float:
    """Return time [s] of impact number `bounce` (1 is the first): t1 (1 + 2 e (1 - e^(n-1)) / (1 - e)), t1 = sqrt(2 h / g)."""
    first = sqrt(2.0 * height / gravity)
    if restitution == 1.0:
        return first * (2 * bounce - 1)
    return first * (1.0 + 2.0 * restitution * (1.0 - restitution ** (bounce - 1)) / (1.0 - restitution))


def zeno_time(height: float, restitution: float, gravity: float) -> float:
    """Return the time [s] at which infinitely many bounces have passed: sqrt(2 h / g) (1 + e) / (1 - e); inf for e = 1."""
    if restitution == 1.0:
        return inf
    return sqrt(2.0 * height / gravity) * (1.0 + restitution) / (1.0 - restitution)


def bounce_state(height: float, restitution: float, gravity: float, time: float) -> tuple[float, float]:
    """Return the height [m] and upward velocity [m/s] at `time` [s] of a ball dropped from rest at `height` [m].

    At the very time of an impact the velocity is the one after it; at rest from the Zeno time on.
    """
    first = sqrt(2.0 * height / gravity)
    if time < first:
        return fall_height(height, 0.0, gravity, time), fall_velocity(0.0, gravity, time)
    if time >= zeno_time(height, restitution, gravity):
        return 0.0, 0.0
    impact = _impacts_until(time / first, restitution)
    # rounding of the logarithm may be one off at an impact itself
    if bounce_time(height, restitution, gravity, impact + 1) <= time:
        impact += 1
    elif bounce_time(height, restitution, gravity, impact) > time:
        impact -= 1
    since = time - bounce_time(height, restitution, gravity, impact)
    up = restitution**impact * impact_speed(height, gravity)
    return fall_height(0.0, up, gravity, since), fall_velocity(up, gravity, since)


def _impacts_until(ratio: float, restitution: float) -> int:
    """Return the number of impacts until `ratio` times the first one's time, from bounce_time solved for n, to one."""
    if restitution == 1.0:
        return max(1, floor((ratio + 1.0) / 2.0))
    left = 1.0 - (ratio - 1.0) * (1.0 - restitution) / (2.0 * restitution) if restitution > 0.0 else 1.0
    return max(1, 1 + floor(log(max(left, 1e-300)) / log(restitution))) if 0.0 < left < 1.0 else 1


def wall_contact_time(distance: float, radius: float, thickness: float, speed: float) -> float:
    """Return the time [s] until a ball at `speed` [m/s], its centre `distance` [m] before a wall's middle, touches the wall."""
    return (distance - radius - 0.5 * thickness) / speed


def two_spheres(mass_a: float, mass_b: float, speed_a: float, speed_b: float, restitution: float) -> tuple[float, float]:
    """Return velocities [m/s] after a central impact: the common velocity minus e times each body's own relative to it."""
    common = (mass_a * speed_a + mass_b * speed_b) / (mass_a + mass_b)
    return (
        common - restitution * mass_b * (speed_a - speed_b) / (mass_a + mass_b),
        common + restitution * mass_a * (speed_a - speed_b) / (mass_a + mass_b),
    )


def superball_speed(light: float, heavy: float, speed: float) -> float:
    """Return speed [m/s] of a light ball on a heavy one, both dropped at `speed`, all impacts elastic: (3 M - m) / (M + m) v."""
    return (3.0 * heavy - light) / (heavy + light) * speed


def cradle_velocities(balls: int, speed: float) -> tuple[float, ...]:
    """Return velocities [m/s] of equal elastic balls in a row with gaps, the first of which came at `speed`: all to the last."""
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
    """Return the bounce of a solid sphere without spin off a wall at `approach` > 0 and `tangential` >= 0 [m/s], `radius` [m].

    Friction stops the slip if mu (1 + e) v_n >= 2/7 v_t, and then v_t' = 5/7 v_t; else v_t' = v_t - mu (1 + e) v_n.
    """
    slide = friction * (1.0 + restitution) * approach
    sticks = slide >= 2.0 / 7.0 * tangential
    lost = 2.0 / 7.0 * tangential if sticks else slide
    return Oblique(restitution * approach, tangential - lost, 2.5 * lost / radius, sticks)


def point_impact(mass: float, inertia: ArrayLike, velocity: ArrayLike, spin: ArrayLike, arm: ArrayLike, normal: ArrayLike,
                 restitution: float) -> tuple[float, Array, Array]:
    """Apply eq. 9 against a fixed world; return impulse j [N s], velocity [m/s] and angular velocity [rad/s] after.

    inertia (3, 3) about the centre of mass, world axes [kg m^2]; `arm` (3,) [m] from that centre to the contact;
    unit `normal` (3,) out of the world into the body. A contact that separates gets no impulse.
    """
    v, w, r, n = (np.asarray(x, dtype=np.float64) for x in (velocity, spin, arm, normal))
    approach = float(n @ (v + np.cross(w, r)))
    turned = np.linalg.solve(np.asarray(inertia, dtype=np.float64), np.cross(r, n))
    j = max(0.0, -(1.0 + restitution) * approach / (1.0 / mass + float(n @ np.cross(turned, r))))
    return j, v + j / mass * n, w + j * turned


def stop_distance(speed: float, friction: float, gravity: float) -> float:
    """Return the way [m] on level ground until a sliding body stops: v^2 / (2 mu g)."""
    return speed * speed / (2.0 * friction * gravity)


def stop_time(speed: float, friction: float, gravity: float) -> float:
    """Return the time [s] on level ground until a sliding body stops: v / (mu g)."""
    return speed / (friction * gravity)


def roll_time(speed: float, friction: float, gravity: float) -> float:
    """Return the time [s] until a solid sphere that starts to slide without spin rolls: 2 v / (7 mu g)."""
    return 2.0 * speed / (7.0 * friction * gravity)


def roll_distance(speed: float, friction: float, gravity: float) -> float:
    """Return the way [m] until it rolls: 12 v^2 / (49 mu g)."""
    return 12.0 * speed * speed / (49.0 * friction * gravity)


def roll_speed(speed: float) -> float:
    """Return the speed [m/s] at which it then rolls on: 5/7 v, whatever the friction."""
    return 5.0 / 7.0 * speed


def incline_acceleration(slope: float, friction: float, gravity: float) -> float:
    """Return the acceleration [m/s^2] of a block released on a plane of `slope` [rad]: g (sin - mu cos), or 0 where it sticks."""
    return max(0.0, gravity * (sin(slope) - friction * cos(slope)))


def rod_angular_velocity(start: float, angle: float, length: float, gravity: float) -> float:
    """Return the angular velocity [rad/s] of a thin rod that falls from rest on a frictionless floor, angles from upright [rad].

    Its centre falls straight down, so energy alone decides: w^2 = 12 g (cos a0 - cos a) / (L (1 + 3 sin^2 a)).
    """
    return sqrt(12.0 * gravity * (cos(start) - cos(angle)) / (length * (1.0 + 3.0 * sin(angle) ** 2)))


def tripod_load(mass: float, gravity: float, rough: float, smooth: float, friction: float, height: float) -> float:
    """Return the load [N] on the one rough foot of a body that slides along on it and on two smooth ones, straight on.

    Feet at `rough` and `smooth` [m] along the way from the centre of mass, which is `height` [m] above the ground. Moments about
    the centre of mass: N_1 x_1 + (m g - N_1) x_2 = mu N_1 h, for the braking force turns the body forward.
    """
    return mass * gravity * smooth / (smooth - rough + friction * height)


def flip_times(moments: Triple, spin: Triple, until: float) -> tuple[float, ...]:
    """Return times [s] up to `until` at which the spin about the middle axis of a free body is zero.

    `moments` [kg m^2] are principal and all different, `spin` [rad/s] is the first angular velocity about the body's own axes.
    With the axis K that keeps its sign (the one of largest moment if L^2 > 2 E I_mid, else of the smallest) and C the third,
    w_mid = B sn(p t + phase, m), B^2 = (L^2 - 2 E I_K) / (I_mid (I_mid - I_K)), and D^2 = B^2 / m the same with C for K.
    """
    low, mid, high = sorted(range(3), key=lambda axis: moments[axis])
    energy_twice = sum(i * w * w for i, w in zip(moments, spin, strict=True))
    square = sum((i * w) ** 2 for i, w in zip(moments, spin, strict=True))
    keeps, other = (high, low) if square > energy_twice * moments[mid] else (low, high)

    def most(axis: int, without: int) -> float:
        """Return the spin about `axis` at which that about `without`'s partner vanishes."""
        part = square - energy_twice * moments[without]
        return sqrt(part / (moments[axis] * (moments[axis] - moments[without])))

    swing, beyond = most(mid, keeps), most(mid, other)
    rate = (moments[high] - moments[low]) / moments[mid] * most(keeps, other) * most(other, keeps) / swing
    parameter = (swing / beyond) ** 2
    quarter = float(ellipk(parameter))
    phase = float(ellipkinc(asin(max(-1.0, min(1.0, spin[mid] / swing))), parameter))
    ahead, behind = (mid + 1) % 3, (mid + 2) % 3
    if (moments[ahead] - moments[behind]) * spin[ahead] * spin[behind] < 0.0:
        phase = 2.0 * quarter - phase
    times, n = [], 0
    while (time := (2.0 * n * quarter - phase) / rate) <= until:
        if time >= 0.0:
            times.append(time)
        n += 1
    return tuple(times)


def top_precession(across: float, along: float, mass: float, reach: float, spin: float, lean: float, gravity: float) -> float:
    """Return the mean rate [rad/s] at which the axis of a top on a smooth plane goes round the vertical.

    The top is let go at `lean` [rad] with `spin` [rad/s] about its own axis and no other turn. `across` and `along` are its
    moments [kg m^2] about its centre of mass, at right angles to the axis and about it; `reach` [m] from the tip to that centre.
    Its spin C w3, its angular momentum about the vertical and its energy stay: with u the cosine of the lean and u0 the first,
    A (1 - u^2) phi' = C w3 (u0 - u) and (A + m l^2 (1 - u^2)) theta'^2 = 2 m g l (u0 - u) - (C w3 (u0 - u))^2 / (A (1 - u^2)).
    It nods between u0 and the root of the latter, and the mean is over one nod.
    """
    first, weight, turn = cos(lean), mass * gravity * reach, along * spin
    stiff = turn * turn / (2.0 * across * weight)
    lowest = 0.5 * (stiff - sqrt(stiff * stiff - 4.0 * (stiff * first - 1.0)))
    middle, half = 0.5 * (first + lowest), 0.5 * (first - lowest)

    def per_swing(s: float, rate: bool) -> float:
        """Return the time, or angle of precession, by the phase s of the nod, u = middle + half cos s, both ends divided out:
        (u0 - u) (u - lowest) is (half sin s)^2, and so is (du/ds)^2."""
        u = middle + half * cos(s)
        square = 1.0 - u * u
        inertia = across + mass * reach * reach * square
        time = sqrt(inertia / (2.0 * weight * (stiff - lowest - u)))
        return time * turn * (first - u) / (across * square) if rate else time

    return float(quad(per_swing, 0.0, pi, args=(True,))[0] / quad(per_swing, 0.0, pi, args=(False,))[0])


def spring_state(offset: float, velocity: float, mass: float, spring: float, damping: float, time: float) -> tuple[float, float]:
    """Return the offset [m] and velocity [m/s] after `time` [s], from their first values; K [N/m], R [N s/m].

    With a = R / 2m and b^2 = a^2 - K/m: e^(-a t) (x0 C + (v0 + a x0) S), C and S = cosh b t, sinh(b t) / b or their
    circular or linear twins.
    """
    decay = damping / (2.0 * mass)
    square = decay * decay - spring / mass
    rate = sqrt(abs(square))
    # below, sinh(b t) / b and t agree to all digits
    if rate * time < 1e-9:
        even, odd = 1.0, time
    elif square < 0.0:
        even, odd = cos(rate * time), sin(rate * time) / rate
    else:
        even, odd = cosh(rate * time), sinh(rate * time) / rate
    fade = exp(-decay * time)
    rise = velocity + decay * offset
    # C' = b^2 S and S' = C
    return (
        fade * (offset * even + rise * odd),
        fade * (offset * square * odd + rise * even) - decay * fade * (offset * even + rise * odd),
    )
