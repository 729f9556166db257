"""Many cases of one question side by side in one scene: materials made for it, and bodies laid where they just do not touch."""

from collections.abc import Iterable, Mapping
from itertools import combinations_with_replacement
from math import hypot

from avatarsim.scene.body import ContactLaw, PairTable
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.spatial import rotation

LAID = 2e-8
"""Gap [m] at which a body is laid on another at the start: free of overlap beyond the judge's rounding, and so small that what
falling through it changes (friction times this, or the square root of 2 g times this in speed) stays below every bound."""

NOWHERE = (0.0, 0.0, 0.0)
"""The origin, and also no gravity and no velocity."""


def pair_table(names: Iterable[str], stated: Mapping[tuple[str, str], ContactLaw]) -> PairTable:
    """Coefficients of made-up materials: the pairs `stated`, and neither bounce nor friction for pairs that never meet."""
    silent: dict[tuple[str, str], ContactLaw] = {
        pair: ContactLaw(0.0, 0.0) for pair in combinations_with_replacement(sorted(names), 2)
    }
    known = {frozenset(pair) for pair in stated}
    return PairTable({**{pair: c for pair, c in silent.items() if frozenset(pair) not in known}, **stated})


def turned_by(axis: Vector, angle: float) -> Quaternion:
    """The turn by `angle` [rad] about `axis`, of any length."""
    length = hypot(*axis)
    unit = (axis[0] / length, axis[1] / length, axis[2] / length)
    w, x, y, z = rotation.from_axis_angle(unit, angle).tolist()
    return w, x, y, z
