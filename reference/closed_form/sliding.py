"""Coulomb friction on planes, and a rod that falls without it."""

from math import cos, sin, sqrt, tan


def stop_distance(speed: float, friction: float, gravity: float) -> float:
    """Way [m] on level ground until a sliding body stops: v^2 / (2 mu g)."""
    return speed * speed / (2.0 * friction * gravity)


def stop_time(speed: float, friction: float, gravity: float) -> float:
    """Time [s] on level ground until a sliding body stops: v / (mu g)."""
    return speed / (friction * gravity)


def roll_time(speed: float, friction: float, gravity: float) -> float:
    """Time [s] until a solid sphere that starts to slide without spin rolls: 2 v / (7 mu g)."""
    return 2.0 * speed / (7.0 * friction * gravity)


def roll_distance(speed: float, friction: float, gravity: float) -> float:
    """Way [m] until it rolls: 12 v^2 / (49 mu g)."""
    return 12.0 * speed * speed / (49.0 * friction * gravity)


def roll_speed(speed: float) -> float:
    """Speed [m/s] at which it then rolls on: 5/7 v, whatever the friction."""
    return 5.0 / 7.0 * speed


def incline_acceleration(slope: float, friction: float, gravity: float) -> float:
    """Acceleration [m/s^2] of a block released on a plane of `slope` [rad]: g (sin - mu cos), or 0 where it sticks."""
    return max(0.0, gravity * (sin(slope) - friction * cos(slope)))


def tips_over(slope: float, base: float, height: float) -> bool:
    """Whether a box of `base` along the slope and `height` [m] tips on a plane of `slope` [rad]: tan > base / height."""
    return tan(slope) > base / height


def rod_angular_velocity(start: float, angle: float, length: float, gravity: float) -> float:
    """Angular velocity [rad/s] of a thin rod that falls from rest on a frictionless floor, angles from upright [rad].

    Its centre falls straight down, so energy alone decides: w^2 = 12 g (cos a0 - cos a) / (L (1 + 3 sin^2 a)).
    """
    return sqrt(12.0 * gravity * (cos(start) - cos(angle)) / (length * (1.0 + 3.0 * sin(angle) ** 2)))


def tripod_load(mass: float, gravity: float, rough: float, smooth: float, friction: float, height: float) -> float:
    """Load [N] on the one rough foot of a body that slides along on it and on two smooth ones, straight on.

    Feet at `rough` and `smooth` [m] along the way from the centre of mass, which is `height` [m] above the ground. Moments about
    the centre of mass: N_1 x_1 + (m g - N_1) x_2 = mu N_1 h, for the braking force turns the body forward.
    """
    return mass * gravity * smooth / (smooth - rough + friction * height)
