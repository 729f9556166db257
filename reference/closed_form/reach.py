"""A planar arm of two links: the law of cosines."""

from math import atan2, hypot, inf, sqrt


def reach_angles(first: float, second: float, x: float, y: float) -> tuple[float, float]:
    """Angles [rad] of shoulder and elbow (against the straight arm, >= 0) that bring the tip of links of these
    lengths [m] to (x, y); the nearest straight or folded posture when the goal is out of reach."""
    distance_square = x * x + y * y
    cosine = (distance_square - first * first - second * second) / (2.0 * first * second)
    cosine = min(1.0, max(-1.0, cosine))
    sine = sqrt(1.0 - cosine * cosine)
    return atan2(y, x) - atan2(second * sine, first + second * cosine), atan2(sine, cosine)


def reach_shortfall(lengths: tuple[float, ...], goal: tuple[float, ...]) -> float:
    """Distance [m] by which a chain of free joints and link `lengths` [m] misses `goal` [m]: too far, too near, or 0."""
    distance, reach, longest = hypot(*goal), sum(lengths), max(lengths, default=-inf)
    return max(0.0, distance - reach, 2.0 * longest - reach - distance)
