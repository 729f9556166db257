"""Free fall and a ball that bounces on a level floor. Heights are of the ball's lowest point above the floor."""

from math import floor, inf, log, sqrt


def fall_height(height: float, velocity: float, gravity: float, time: float) -> float:
    """Height [m] after `time` [s] of free fall from `height` [m] with upward `velocity` [m/s]: h + v t - g t^2 / 2."""
    return height + velocity * time - 0.5 * gravity * time * time


def fall_velocity(velocity: float, gravity: float, time: float) -> float:
    """Upward velocity [m/s] after `time` [s] of free fall: v - g t."""
    return velocity - gravity * time


def semi_implicit_fall_error(gravity: float, time: float, step: float) -> float:
    """How much lower [m] than the parabola a semi-implicit Euler fall of equal steps [s] is after `time` [s]: g t dt / 2."""
    return 0.5 * gravity * time * step


def impact_speed(height: float, gravity: float) -> float:
    """Speed [m/s] at the floor after a drop from rest at `height` [m]: sqrt(2 g h)."""
    return sqrt(2.0 * gravity * height)


def apex_height(height: float, restitution: float, bounces: int) -> float:
    """Greatest height [m] after so many bounces, dropped from rest at `height` [m]: e^(2 n) h."""
    return restitution ** (2 * bounces) * height


def bounce_time(height: float, restitution: float, gravity: float, bounce: int) -> float:
    """Time [s] of impact number `bounce` (1 is the first): t1 (1 + 2 e (1 - e^(n-1)) / (1 - e)), t1 = sqrt(2 h / g)."""
    first = sqrt(2.0 * height / gravity)
    if restitution == 1.0:
        return first * (2 * bounce - 1)
    return first * (1.0 + 2.0 * restitution * (1.0 - restitution ** (bounce - 1)) / (1.0 - restitution))


def zeno_time(height: float, restitution: float, gravity: float) -> float:
    """Time [s] at which infinitely many bounces have passed: sqrt(2 h / g) (1 + e) / (1 - e); inf for e = 1."""
    if restitution == 1.0:
        return inf
    return sqrt(2.0 * height / gravity) * (1.0 + restitution) / (1.0 - restitution)


def bounce_path(height: float, restitution: float) -> float:
    """Length [m] of the whole way up and down until rest: h (1 + e^2) / (1 - e^2); inf for e = 1."""
    if restitution == 1.0:
        return inf
    return height * (1.0 + restitution**2) / (1.0 - restitution**2)


def bounce_state(height: float, restitution: float, gravity: float, time: float) -> tuple[float, float]:
    """Height [m] and upward velocity [m/s] at `time` [s] of a ball dropped from rest at `height` [m].

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
    """Number of impacts until `ratio` times the first one's time, from bounce_time solved for n, to one."""
    if restitution == 1.0:
        return max(1, floor((ratio + 1.0) / 2.0))
    left = 1.0 - (ratio - 1.0) * (1.0 - restitution) / (2.0 * restitution) if restitution > 0.0 else 1.0
    return max(1, 1 + floor(log(max(left, 1e-300)) / log(restitution))) if 0.0 < left < 1.0 else 1


def wall_contact_time(distance: float, radius: float, thickness: float, speed: float) -> float:
    """Time [s] until a ball at `speed` [m/s], its centre `distance` [m] before a wall's middle, touches the wall."""
    return (distance - radius - 0.5 * thickness) / speed
