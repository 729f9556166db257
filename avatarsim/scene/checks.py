"""Checks of values from users: of the right type, finite, positive, of the right shape."""

import math
from collections.abc import Iterable
from types import UnionType
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.errors import InvalidInput, InvalidScene

DEEPEST = 3
"""Lists within lists that an array may be given as: no quantity of a scene has more axes than a matrix per part."""

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

SHORTEST, LONGEST = 1e-6, 1e7
"""Lengths [m] that a shape may have: from a tenth of a grain of dust's to past the Earth's radius. Outside, volumes and
inertias, which grow with the third and fifth power, leave the range in which sums of them mean anything."""

FARTHEST = 1e8
"""Largest coordinate [m] of any part of a scene. Coordinates there are rounded to 1.5e-8 m, a hundredth of the smallest gap that
the engine keeps (`wedged_gap`). Farther: rounding eats the gaps, and shown bodies may overlap."""

FASTEST = 1e6
"""Largest velocity component [m/s] with which a body begins. In a frame of 1 s, the longest, the instant of an impact is known
to 1e-16 s: 1e-10 m of way, which nothing shows; and `FARTHEST` is reached after 100 s at the earliest. Faster: either fails."""

FASTEST_SPIN = 1e4
"""Largest component of the angular velocity [rad/s] with which a body begins: 95,000 turns a minute, a fast turbine. The search
for the instant of an impact goes by parts of a turn: over a floor a disc or a box of 0.3 m takes up to 40 ms in a frame with 1e4
rad/s, 0.3 s with 1e5, and with 1e6 most of a second in every frame."""


def as_number(value: object) -> float:
    """Return `value` as a float; nan, which no range holds, if it is no number."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def positive(thing: str, value: object, error: type[InvalidInput] = InvalidScene) -> float:
    """Return `value` as a float, or raise an error that it must be finite and above 0."""
    number = as_number(value)
    if not 0.0 < number < math.inf:
        raise error(thing, value, "a finite number above 0")
    return number


def within(thing: str, value: object, low: float, high: float, error: type[InvalidInput] = InvalidScene) -> float:
    """Return `value` as a float, or raise an error that states the closed interval [low, high]."""
    number = as_number(value)
    if not low <= number <= high:
        raise error(thing, value, f"a finite number from {low:g} to {high:g}")
    return number


def length(thing: str, value: object, error: type[InvalidInput] = InvalidScene) -> float:
    """Return `value` [m] as a float, or raise an error that states the lengths that a shape may have."""
    return within(f"{thing} [m]", value, SHORTEST, LONGEST, error)


def instance(
    thing: str, value: object, kind: type[object] | UnionType, valid: str, error: type[InvalidInput] = InvalidScene
) -> None:
    """Raise unless `value` is of type `kind`; `valid` describes that in words."""
    if not isinstance(value, kind):
        raise error(thing, value, valid)


def each(thing: str, values: object, kind: type[object], valid: str, error: type[InvalidInput] = InvalidScene) -> None:
    """Raise unless `values` is a tuple whose entries are all of type `kind`; `valid` describes one of them in words. A list could
    be changed once it has been checked."""
    if not isinstance(values, tuple):
        raise error(thing, values, f"a tuple, each entry {valid}")
    for k, value in enumerate(values):
        if not isinstance(value, kind):
            raise error(f"{thing}, entry {k}", value, valid)


def name_pairs(thing: str, pairs: object) -> None:
    """Raise InvalidScene unless `pairs` is a tuple of pairs of names."""
    each(thing, pairs, tuple, "a pair of names")
    for k, pair in enumerate(cast(tuple[tuple[object, ...], ...], pairs)):
        if len(pair) != 2 or not all(isinstance(name, str) for name in pair):
            raise InvalidScene(f"{thing}, entry {k}", pair, "a pair of names")


def depths(thing: str, entries: object) -> tuple[tuple[str, str, float], ...]:
    """Return pairs of names, each with a depth [m], an equal pair once; or raise InvalidScene."""
    each(thing, entries, tuple, "two names and a depth [m]")
    found = []
    for k, entry in enumerate(cast(tuple[tuple[object, ...], ...], entries)):
        if len(entry) != 3 or not all(isinstance(name, str) for name in entry[:2]) or entry[0] == entry[1]:
            raise InvalidScene(f"{thing}, entry {k}", entry, "two different names and a depth [m]")
        a, b = str(entry[0]), str(entry[1])
        found.append((a, b, within(f"depth of {a} and {b} in {thing} [m]", entry[2], 0.0, LONGEST)))
    distinct(f"pair in {thing}", (" and ".join(sorted(entry[:2])) for entry in found))
    return tuple(found)


def named(thing: str, name: object) -> None:
    """Raise InvalidScene unless `name` is a text that is not blank."""
    if not isinstance(name, str) or not name.strip():
        raise InvalidScene(f"name of {thing}", name, "a text that is not empty")


def finite_array(thing: str, value: ArrayLike, shape: tuple[int, ...], error: type[InvalidInput] = InvalidScene) -> Array:
    """Return `value` as a float64 array of `shape` (-1 matches any length) with finite entries only."""
    try:
        array = real_array(value)
    except (TypeError, ValueError, OverflowError):
        raise error(thing, value, f"real numbers of shape {shape}") from None
    fits = array.ndim == len(shape) and all(want in (-1, got) for want, got in zip(shape, array.shape, strict=True))
    if not fits:
        raise error(f"shape of {thing}", array.shape, f"{shape}, where -1 is any length")
    if not np.isfinite(array).all():
        raise error(thing, array.tolist(), "finite numbers only")
    return array


def require_near(thing: str, places: Array, error: type[InvalidInput] = InvalidScene) -> None:
    """Raise if a coordinate of `places` [m] is beyond `FARTHEST`."""
    if not (np.abs(places) <= FARTHEST).all():
        raise error(f"{thing} [m]", places.tolist(), f"coordinates from {-FARTHEST:g} to {FARTHEST:g}")


def real_array(value: ArrayLike) -> Array:
    """Return a float64 array of its own of real numbers; TypeError for values that numpy would convert silently: texts, complex
    and truth values, and masked arrays, whose masks it would drop."""
    if isinstance(value, np.ma.MaskedArray):
        raise TypeError("a masked array")
    if not _is_plain(value, DEEPEST):
        raise TypeError("no numbers, nor lists of numbers")
    found = np.asarray(value)
    if found.dtype.kind not in "iuf":
        raise TypeError(f"an array of {found.dtype}")
    return np.array(found, dtype=np.float64)


def _is_plain(value: object, depth: int) -> bool:
    """Return True if `value` may go to numpy: of an object that has a length and parts without end it makes an array of as many
    dimensions as it can, and of a truth value among numbers a number."""
    if isinstance(value, (list, tuple)):
        return depth > 0 and all(_is_plain(part, depth - 1) for part in value)
    if isinstance(value, (bool, np.bool_)):
        return False
    return isinstance(value, (int, float, np.integer, np.floating)) or hasattr(value, "__array__")


def bounded(thing: str, value: Iterable[float], most: float, error: type[InvalidInput] = InvalidScene) -> Vector:
    """Return a finite 3-vector as a tuple, none of its components larger than `most`."""
    found = vector(thing, value, error)
    if not max(map(abs, found)) <= most:
        raise error(thing, found, f"components from {-most:g} to {most:g}")
    return found


def place(thing: str, value: Iterable[float], error: type[InvalidInput] = InvalidScene) -> Vector:
    """Return a position [m] as a tuple, within `FARTHEST`."""
    return bounded(f"{thing} [m]", value, FARTHEST, error)


def parts(value: object) -> ArrayLike:
    """Return an array as it is, whose type gives its kind; of all else the parts."""
    return value if isinstance(value, np.ndarray) else cast(ArrayLike, listed(value))


def listed(value: object) -> list[object]:
    """Return the parts of a vector; a value without parts is its own only part, which no shape fits."""
    # an array of no dimensions is iterable by its type alone
    return list(value) if isinstance(value, Iterable) and not (isinstance(value, np.ndarray) and value.ndim == 0) else [value]


def pair(thing: str, value: object) -> tuple[object, object]:
    """Return two parts, not yet checked themselves."""
    parts = listed(value)
    if len(parts) != 2:
        raise InvalidScene(thing, value, "two numbers")
    return parts[0], parts[1]


def vector(thing: str, value: Iterable[float], error: type[InvalidInput] = InvalidScene) -> Vector:
    """Return a finite 3-vector as a tuple."""
    x, y, z = finite_array(thing, parts(value), (3,), error)
    return float(x), float(y), float(z)


def unit_vector(thing: str, value: Iterable[float]) -> Vector:
    """Return a finite, non-zero 3-vector, scaled to length 1."""
    array = finite_array(thing, parts(value), (3,))
    length = float(np.linalg.norm(array))
    if not length > 1e-12:
        raise InvalidScene(thing, array.tolist(), "a vector of non-zero length")
    x, y, z = array / length
    return float(x), float(y), float(z)


def unit_quaternion(thing: str, value: Iterable[float], error: type[InvalidInput] = InvalidScene) -> Quaternion:
    """Return a quaternion (w, x, y, z) of length 1 to 1e-6, normalised to rounding."""
    array = finite_array(thing, parts(value), (4,), error)
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
