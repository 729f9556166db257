"""The one place where values handed in are checked: finite, positive, of the right shape."""

import math
from collections.abc import Iterable
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.errors import InvalidInput, InvalidScene

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

SHORTEST, LONGEST = 1e-6, 1e7
"""Lengths [m] that a shape may have: from a tenth of a grain of dust's to past the Earth's radius. Outside, volumes and
inertias, which grow with the third and fifth power, leave the range in which sums of them mean anything."""


def as_number(value: object) -> float:
    """`value` as a float; nan, which no range holds, if it is no number."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def positive(thing: str, value: object, error: type[InvalidInput] = InvalidScene) -> float:
    """`value` as a float, or an error that says it must be finite and above 0."""
    number = as_number(value)
    if not 0.0 < number < math.inf:
        raise error(thing, value, "a finite number above 0")
    return number


def within(thing: str, value: object, low: float, high: float, error: type[InvalidInput] = InvalidScene) -> float:
    """`value` as a float, or an error that states the closed interval [low, high]."""
    number = as_number(value)
    if not low <= number <= high:
        raise error(thing, value, f"a finite number from {low:g} to {high:g}")
    return number


def length(thing: str, value: object, error: type[InvalidInput] = InvalidScene) -> float:
    """`value` [m] as a float, or an error that states the lengths that a shape may have."""
    return within(f"{thing} [m]", value, SHORTEST, LONGEST, error)


def named(thing: str, name: object) -> None:
    """Raise InvalidScene unless `name` is a text that can be read and told apart from nothing."""
    if not isinstance(name, str) or not name.strip():
        raise InvalidScene(f"name of {thing}", name, "a text that is not empty")


def finite_array(thing: str, value: ArrayLike, shape: tuple[int, ...], error: type[InvalidInput] = InvalidScene) -> Array:
    """`value` as a float64 array of `shape` (-1 matches any length) with finite entries only."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise error(thing, value, f"numbers of shape {shape}") from None
    fits = array.ndim == len(shape) and all(want in (-1, got) for want, got in zip(shape, array.shape, strict=True))
    if not fits:
        raise error(f"shape of {thing}", array.shape, f"{shape}, where -1 is any length")
    if not np.isfinite(array).all():
        raise error(thing, array.tolist(), "finite numbers only")
    return array


def listed(value: object) -> list[object]:
    """The parts of a vector; a value without parts is its own only part, which no shape fits."""
    return list(value) if isinstance(value, Iterable) else [value]


def pair(thing: str, value: object) -> tuple[object, object]:
    """Two parts, not yet checked themselves."""
    parts = listed(value)
    if len(parts) != 2:
        raise InvalidScene(thing, value, "two numbers")
    return parts[0], parts[1]


def vector(thing: str, value: Iterable[float], error: type[InvalidInput] = InvalidScene) -> Vector:
    """A finite 3-vector as a tuple."""
    x, y, z = finite_array(thing, cast(ArrayLike, listed(value)), (3,), error)
    return float(x), float(y), float(z)


def unit_vector(thing: str, value: Iterable[float]) -> Vector:
    """A finite, non-zero 3-vector, scaled to length 1."""
    array = finite_array(thing, cast(ArrayLike, listed(value)), (3,))
    length = float(np.linalg.norm(array))
    if not length > 1e-12:
        raise InvalidScene(thing, array.tolist(), "a vector of non-zero length")
    x, y, z = array / length
    return float(x), float(y), float(z)


def unit_quaternion(thing: str, value: Iterable[float], error: type[InvalidInput] = InvalidScene) -> Quaternion:
    """A quaternion (w, x, y, z) of length 1 to 1e-6, normalised to rounding."""
    array = finite_array(thing, cast(ArrayLike, listed(value)), (4,), error)
    length = float(np.linalg.norm(array))
    if not abs(length - 1.0) <= 1e-6:
        raise error(thing, array.tolist(), "a quaternion (w, x, y, z) of length 1, to 1e-6")
    w, x, y, z = array / length
    return float(w), float(x), float(y), float(z)


def distinct(thing: str, names: Iterable[str]) -> None:
    """Raise when a name occurs twice."""
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise InvalidScene(thing, name, "names that occur once only")
        seen.add(name)
