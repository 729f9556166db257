"""Marks of fields: which are kept from frame to frame, and the range of their whole numbers; and arenas of marked fields."""

from typing import Annotated, NamedTuple

import numpy as np
import pytest

from avatarsim.jit.arena import FIRST, pack
from avatarsim.jit.kept import COUNT, FLAG, KEPT, NOT_KEPT, PIECE, Sizes, Whole, hints_of, is_kept, kept_names, whole_of
from avatarsim.jit.layout import IndexLine, Line

SIZES = Sizes(bodies=3, pieces=5, avatars=1)


class Inner(NamedTuple):
    """One field of each kind."""

    plain: Line
    scratch: Annotated[Line, NOT_KEPT]
    counted: Annotated[IndexLine, KEPT, COUNT]


class Outer(NamedTuple):
    """The same in a kept field and in working memory."""

    state: Inner
    working: Annotated[Inner, NOT_KEPT]
    flags: Annotated[IndexLine, FLAG]


class Unmarked(NamedTuple):
    """The arrays of Outer without marks."""

    state: Inner
    working: Inner
    flags: IndexLine


def test_a_field_inherits_unless_it_is_marked() -> None:
    inner, outer = hints_of(Inner), hints_of(Outer)
    assert kept_names(Outer) == ("state", "flags") and kept_names(Inner) == ("plain", "counted")
    inherited = is_kept(outer["working"])
    assert [is_kept(inner[name], inherited) for name in Inner._fields] == [False, False, True]


@pytest.mark.parametrize(("whole", "expected"), [
    (FLAG, (0, 1)), (PIECE, (0, 4)), (Whole(-1, lambda sizes: sizes.rows - 1), (-1, 6)),
    (Whole(0, lambda sizes: sizes.avatars - 2), (0, 0)),
])
def test_a_range_follows_the_sizes_of_the_world(whole: Whole, expected: tuple[int, int]) -> None:
    assert whole.range_for(SIZES._replace(rows=7)) == expected


def test_marks_do_not_change_the_layout() -> None:
    assert whole_of(hints_of(Outer)["flags"]) is FLAG and whole_of(hints_of(Unmarked)["flags"]) is None
    inner, counts = Inner(np.ones(2), np.zeros(1), np.arange(3)), np.zeros(4, dtype=np.int64)
    (marked, view), (unmarked, _) = pack(Outer(inner, inner, counts)), pack(Unmarked(inner, inner, counts))
    np.testing.assert_array_equal(view.working.counted, np.arange(3))
    # all but the tag, which has the name of the tuple
    np.testing.assert_array_equal(np.delete(marked, FIRST - 1), np.delete(unmarked, FIRST - 1))
