"""Fields of named tuples that pass from frame to frame, and ranges of their whole numbers, stated in the fields' annotations.

A field is kept unless it is marked `NOT_KEPT`, or belongs to one that is and has no `KEPT` of its own.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, Final, NamedTuple, get_type_hints

MOST: Final = 2**60
"""Largest number that is counted on: from there on counting takes longer than the Earth is old."""


class Sizes(NamedTuple):
    """Numbers of bodies, of their pieces and of avatars of a world, and of rows of the array itself."""

    bodies: int
    pieces: int
    avatars: int
    rows: int = 0


@dataclass(frozen=True)
class Mark:
    """Mark of a field that passes from frame to frame, or does not."""

    is_kept: bool


KEPT: Final = Mark(True)
"""The field passes from frame to frame, though that which it belongs to does not."""
NOT_KEPT: Final = Mark(False)
"""The field is constant, or filled anew in each frame before it is read."""

Bound = int | Callable[[Sizes], int]


@dataclass(frozen=True, eq=False)
class Whole:
    """Whole numbers from `least` to `most`; either may depend on the sizes of the world."""

    least: Bound
    most: Bound

    def range_for(self, sizes: Sizes) -> tuple[int, int]:
        """Return the least and the largest value in a world of these sizes."""
        least, most = (bound if isinstance(bound, int) else bound(sizes) for bound in (self.least, self.most))
        return least, max(least, most)


FLAG: Final = Whole(0, 1)
COUNT: Final = Whole(0, MOST)
COUNT_OR_NONE: Final = Whole(-1, MOST)
BODY: Final = Whole(0, lambda sizes: sizes.bodies - 1)
BODY_OR_NONE: Final = Whole(-1, lambda sizes: sizes.bodies - 1)
PIECE: Final = Whole(0, lambda sizes: sizes.pieces - 1)
AVATAR: Final = Whole(0, lambda sizes: sizes.avatars - 1)


@cache
def hints_of(kind: type) -> dict[str, Any]:
    """Return annotations of a named tuple or of the columns of a table, by name; of other tuples none."""
    return get_type_hints(kind, include_extras=True)


def is_kept(annotation: Any, inherited: bool = True) -> bool:
    """Return whether a field with this annotation is kept, which it is where that it belongs to is (`inherited`)."""
    return next((one.is_kept for one in getattr(annotation, "__metadata__", ()) if isinstance(one, Mark)), inherited)


def whole_of(annotation: Any) -> Whole | None:
    """Return the range that an annotation states; None without."""
    return next((one for one in getattr(annotation, "__metadata__", ()) if isinstance(one, Whole)), None)


def kept_names(kind: Any) -> tuple[str, ...]:
    """Return names of the fields of a named tuple that are kept."""
    return tuple(name for name in kind._fields if is_kept(hints_of(kind)[name]))
