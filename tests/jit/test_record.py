"""A record goes through arguments, tuples and results as the same memory, compiled or not."""

from typing import NamedTuple

import numpy as np
import pytest

from avatarsim.jit.arena import opened, packed
from avatarsim.jit.kernel import kernel
from avatarsim.jit.record import known_as_table, known_by_pointer

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


class Box(np.record):
    """A record with an array in it."""

    w: np.ndarray
    k: int


class Boxes(np.recarray):
    """A table of them."""

    w: np.ndarray
    k: np.ndarray


LAYOUT = np.dtype([("w", np.float64, (4, 3)), ("k", np.int64)], align=True)
KIND = np.dtype((Box, LAYOUT))
known_by_pointer(Box, KIND)
known_as_table(Boxes, LAYOUT)


class Two(NamedTuple):
    """A tuple that holds one."""

    number: float
    box: Box


class Many(NamedTuple):
    """A tuple that holds a table."""

    boxes: Boxes


@kernel
def wrapped(box: Box) -> Two:
    """In a tuple, as a result."""
    return Two(2.0, box)


@kernel
def doubled(words: np.ndarray) -> float:
    """Through words, an argument, a tuple and a result to a row that is written to."""
    two = wrapped(opened(words, Two).box)
    two.box.w[2, 1] *= two.number
    return two.box.w[2, 1]


@kernel
def written(box: Box, two: Two) -> None:
    """From Python, bare and in a tuple."""
    box.w[0, 0] += 1.0
    two.box.w[0, 1] += two.number


@kernel
def table_sum(words: np.ndarray) -> float:
    """Row by row and field by field."""
    boxes = opened(words, Many).boxes
    boxes[1].w[0, 0] = 5.0
    return boxes.w[1, 0, 0] + boxes[2].k + boxes.k[2]


def fresh() -> Box:
    """All zero."""
    return np.zeros(1, KIND)[0]


def test_python_and_kernels_share_the_memory():
    box, other = fresh(), fresh()
    written(box, Two(3.0, other))
    written(box, Two(3.0, box))
    assert box.w[0, 0] == 2.0 and box.w[0, 1] == 3.0 and other.w[0, 1] == 3.0


def test_words_are_opened_as_the_record_that_lies_in_them():
    words, (_, box) = packed(Two(0.0, fresh()))
    box.w[2, 1] = 4.0
    assert doubled(words) == 8.0 and box.w[2, 1] == 8.0


def test_a_table_is_read_by_rows_and_by_fields():
    words, (boxes,) = packed(Many(np.zeros(3, LAYOUT).view(Boxes)))
    boxes.k[2] = 7
    assert isinstance(boxes, Boxes) and table_sum(words) == 19.0 and boxes[1].w[0, 0] == 5.0
