"""The Pareto front: points that no other beats in both time and error."""

from collections.abc import Sequence
from math import isfinite

Point = tuple[float, float]
"""Time and error; a point that is not finite is on no front and beats nobody."""


def beats(a: Point, b: Point) -> bool:
    """Whether `a` is at least as good as `b` in both and better in one."""
    return a[0] <= b[0] and a[1] <= b[1] and a != b


def front(points: Sequence[Point]) -> list[bool]:
    """For each point whether nobody beats it, in one pass over the points sorted by time."""
    found = [False] * len(points)
    usable = [k for k, (time, error) in enumerate(points) if isfinite(time) and isfinite(error)]
    least, best = float("inf"), (float("nan"), float("nan"))
    for k in sorted(usable, key=lambda k: points[k]):
        # equals of a point on the front are on it too
        if points[k][1] < least or points[k] == best:
            found[k], least, best = True, points[k][1], points[k]
    return found
