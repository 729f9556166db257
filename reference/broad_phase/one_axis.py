"""The plain sweep along one axis, from a list kept sorted between frames: what we had, and measure ourselves against."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.broad_phase import boxes_meet
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import PairFilter, may_meet

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@kernel
def widest_axis(boxes: Array) -> int:
    """The axis along which box centres vary most."""
    best, widest = 0, -1.0
    for axis in range(3):
        total, squares, base = 0.0, 0.0, boxes[0, axis] + boxes[0, axis + 3]
        for i in range(boxes.shape[0]):
            centre = boxes[i, axis] + boxes[i, axis + 3] - base
            total += centre
            squares += centre * centre
        spread = squares - total * total / boxes.shape[0]
        if spread > widest:
            best, widest = axis, spread
    return best


@kernel
def one_axis(boxes: Array, wanted: PairFilter, order_out: Index, pairs_out: Index) -> int:
    """Pairs that meet, in an order that depends on ``order_out`` (n), a permutation kept from call to call; how many."""
    axis, count = widest_axis(boxes), 0
    for k in range(1, order_out.shape[0]):
        box, at = order_out[k], k
        while at > 0 and boxes[order_out[at - 1], axis] > boxes[box, axis]:
            order_out[at] = order_out[at - 1]
            at -= 1
        order_out[at] = box
    for k in range(order_out.shape[0]):
        box = order_out[k]
        for after in range(k + 1, order_out.shape[0]):
            other = order_out[after]
            if boxes[other, axis] > boxes[box, axis + 3]:
                break
            if boxes_meet(boxes, box, other) and may_meet(wanted, box, other):
                if count < pairs_out.shape[0]:
                    pairs_out[count, 0], pairs_out[count, 1] = min(box, other), max(box, other)
                count += 1
    return count
