"""Sorted list of pairs: heapsort of the new ones, then a merge."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel

Index = NDArray[np.int64]


@kernel
def sort_ascending(keys: Index, count: int) -> None:
    """Heapsort of the first ``count`` keys, in place; lists of a few are sorted by insertion."""
    if count <= 16:
        for k in range(1, count):
            key, at = keys[k], k
            while at > 0 and keys[at - 1] > key:
                keys[at] = keys[at - 1]
                at -= 1
            keys[at] = key
        return
    for root in range(count // 2 - 1, -1, -1):
        sift_down(keys, root, count)
    for last in range(count - 1, 0, -1):
        keys[0], keys[last] = keys[last], keys[0]
        sift_down(keys, 0, last)


@kernel
def sift_down(keys: Index, root: int, count: int) -> None:
    """Let the key at ``root`` sink to its place in the heap of the first ``count`` keys."""
    key, at = keys[root], root
    while True:
        child = 2 * at + 1
        if child >= count:
            break
        if child + 1 < count and keys[child + 1] > keys[child]:
            child += 1
        if keys[child] <= key:
            break
        keys[at] = keys[child]
        at = child
    keys[at] = key


@kernel
def merge_ascending(keys: Index, count: int, fresh: Index, more: int) -> None:
    """Merge ``more`` ascending fresh keys into the first ``count`` of ``keys``, which has room for both."""
    left, right = count - 1, more - 1
    while right >= 0:
        if left >= 0 and keys[left] > fresh[right]:
            keys[left + right + 1] = keys[left]
            left -= 1
        else:
            keys[left + right + 1] = fresh[right]
            right -= 1
