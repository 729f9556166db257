"""Sweep and prune: which bounding boxes meet, from a list kept sorted between frames (Algorithm 1, step
1)."""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.status import CONVERGED, NOT_FINITE, OUT_OF_ROOM
from avatarsim.kernel import kernel

Boxes = NDArray[np.float64]
"""(nb, 6): lowest x y z, highest x y z [m]."""


@kernel
def boxes_meet(boxes: Boxes, i: int, j: int) -> bool:
    """Whether boxes i and j share a point; boxes that only touch do."""
    for axis in range(3):
        if boxes[i, axis] > boxes[j, axis + 3] or boxes[j, axis] > boxes[i, axis + 3]:
            return False
    return True


@kernel
def axis_of_greatest_spread(boxes: Boxes) -> int:
    """The axis along which the box centres vary most; -1 if a bound is not finite."""
    best, widest = 0, -1.0
    for axis in range(3):
        total, squares = 0.0, 0.0
        # Relative to the first centre: far from the origin the squares would cancel.
        base = boxes[0, axis] + boxes[0, axis + 3]
        for i in range(boxes.shape[0]):
            centre = boxes[i, axis] + boxes[i, axis + 3] - base
            total += centre
            squares += centre * centre
        spread = squares - total * total / boxes.shape[0]
        if not (abs(spread) < inf):
            return -1
        if spread > widest:
            best, widest = axis, spread
    return best


@kernel
def sort_along(boxes: Boxes, axis: int, order_out: NDArray[np.int64]) -> None:
    """Insertion sort of ``order_out`` by the boxes' lower bounds: nearly free if it is nearly sorted."""
    for k in range(1, order_out.shape[0]):
        box = order_out[k]
        low = boxes[box, axis]
        at = k
        while at > 0 and boxes[order_out[at - 1], axis] > low:
            order_out[at] = order_out[at - 1]
            at -= 1
        order_out[at] = box


@kernel
def sweep_and_prune(
    boxes: Boxes, allowed: NDArray[np.bool_], order_out: NDArray[np.int64], pairs_out: NDArray[np.int64]
) -> tuple[int, int]:
    """Find all pairs of boxes that meet.

    Args:
        boxes: (nb, 6) lowest and highest coordinates [m].
        allowed: (nb, nb) whether a pair is of interest; read at [i, j] with i < j.
        order_out: (nb,) a permutation of the boxes, kept by the caller from call to call.
        pairs_out: (cap, 2) the pairs, i < j, in an order that depends on ``order_out``.

    Returns:
        (status, count). OUT_OF_ROOM: count says how many there are, of which the first cap were written.
        NOT_FINITE: a bound is nan or infinite, nothing was written.
    """
    if boxes.shape[0] < 2:
        return CONVERGED, 0
    axis = axis_of_greatest_spread(boxes)
    if axis < 0:
        return NOT_FINITE, 0
    sort_along(boxes, axis, order_out)
    count = 0
    for k in range(order_out.shape[0]):
        box = order_out[k]
        high = boxes[box, axis + 3]
        for after in range(k + 1, order_out.shape[0]):
            other = order_out[after]
            if boxes[other, axis] > high:
                break
            i, j = min(box, other), max(box, other)
            if allowed[i, j] and boxes_meet(boxes, i, j):
                if count < pairs_out.shape[0]:
                    pairs_out[count, 0], pairs_out[count, 1] = i, j
                count += 1
    return (CONVERGED if count <= pairs_out.shape[0] else OUT_OF_ROOM), count


@kernel
def all_pairs(boxes: Boxes, allowed: NDArray[np.bool_], pairs_out: NDArray[np.int64]) -> tuple[int, int]:
    """The dumb twin of `sweep_and_prune`: every pair is tried; the order is i, then j."""
    count = 0
    for i in range(boxes.shape[0]):
        for j in range(i + 1, boxes.shape[0]):
            if allowed[i, j] and boxes_meet(boxes, i, j):
                if count < pairs_out.shape[0]:
                    pairs_out[count, 0], pairs_out[count, 1] = i, j
                count += 1
    return (CONVERGED if count <= pairs_out.shape[0] else OUT_OF_ROOM), count
