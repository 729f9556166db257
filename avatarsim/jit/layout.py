"""Fields of named tuples, described by their annotations: arrays with their axes, records, tables, numbers, named tuples."""

from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from typing import Annotated, Any, get_type_hints

import numba
import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import AvatarsimError
from avatarsim.jit.record import RECORDS, TABLES

types: Any = numba.types
Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Axes:
    """Number of axes of an array, and type of its elements."""

    count: int
    kind: type[np.generic]


Line = Annotated[Array, Axes(1, np.float64)]
"""Numbers (n)."""
Grid = Annotated[Array, Axes(2, np.float64)]
"""Numbers (n, m)."""
Vectors = Annotated[Array, Axes(2, np.float64)]
"""Numbers (n, 3)."""
Cube = Annotated[Array, Axes(3, np.float64)]
"""Numbers (n, m, k)."""
Matrices = Annotated[Array, Axes(3, np.float64)]
"""Numbers (n, 3, 3)."""
Stack = Annotated[Array, Axes(4, np.float64)]
"""Numbers of four axes."""
IndexLine = Annotated[Index, Axes(1, np.int64)]
"""Integers (n)."""
IndexGrid = Annotated[Index, Axes(2, np.int64)]
"""Integers (n, m)."""
FlagLine = Annotated[Flags, Axes(1, np.bool_)]
"""Flags (n)."""
FlagGrid = Annotated[Flags, Axes(2, np.bool_)]
"""Flags (n, m)."""

NUMBERS: dict[object, Any] = {float: types.float64, int: types.int64, bool: types.boolean}
"""Kind of number -> numba's type of it."""


@cache
def numba_type(kind: Any) -> Any:
    """Return numba's type of a field with this annotation."""
    if kind in NUMBERS:
        return NUMBERS[kind]
    if kind in RECORDS:
        return RECORDS[kind]
    if kind in TABLES:
        return types.Array(numba.from_dtype(TABLES[kind]), 1, "C")
    if axes := axes_of(kind):
        return types.Array(numba.from_dtype(np.dtype(axes.kind)), axes.count, "C")
    return types.BaseTuple.from_types(tuple(map(numba_type, fields(kind))), kind)


def unmarked(kind: Any) -> Any:
    """Return the annotation of a field that is no array without its marks, which say nothing of its layout."""
    return kind.__origin__ if hasattr(kind, "__metadata__") and axes_of(kind) is None else kind


def axes_of(kind: Any) -> Axes | None:
    """Return the axes of a field with this annotation; None if that is no array."""
    return next((one for one in getattr(kind, "__metadata__", ()) if isinstance(one, Axes)), None)


@cache
def fields(kind: Any) -> tuple[Any, ...]:
    """Return annotations of the fields of a named tuple, in their order, without marks that say nothing of the layout."""
    if not hasattr(kind, "_fields"):
        raise AvatarsimError(f"an arena holds no {kind}: this is a defect")
    hints = get_type_hints(kind, include_extras=True)
    return tuple(unmarked(hints[name]) for name in kind._fields)


def layout_tag(kind: Any) -> int:
    """Return a number that differs between named tuples whose fields differ in name, order or type."""
    return int.from_bytes(sha256(_described(kind).encode()).digest()[:7])


def _described(kind: Any) -> str:
    if kind in NUMBERS:
        return str(NUMBERS[kind])
    if kind in RECORDS:
        return str(RECORDS[kind].layout)
    if kind in TABLES:
        return f"{TABLES[kind]} table"
    if axes := axes_of(kind):
        return f"{axes.count} {axes.kind.__name__}"
    inner = (f"{name}: {_described(one)}" for name, one in zip(kind._fields, fields(kind), strict=True))
    return f"{kind.__name__}({', '.join(inner)})"
