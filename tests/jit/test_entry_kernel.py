"""A kernel that runs a whole stage lets other Python threads run, and many arenas are handed to it by their addresses."""

from threading import Thread
from typing import NamedTuple

import numpy as np
import pytest

from avatarsim.jit.arena import opened, packed, words_at
from avatarsim.jit.kernel import WITHOUT_LOCK, entry_kernel, kernel
from avatarsim.jit.layout import IndexLine, Line
from avatarsim.jit.linking import KernelDispatcher

MOST = 10**9
"""Looks of a kernel at a flag: a second or so. Another thread sets the flag within milliseconds, or never."""


@entry_kernel
def seen(flags: np.ndarray, where: np.ndarray) -> bool:
    """Whether another thread sets a flag while this looks at it; by an index that no compiler knows, or it would be read once."""
    for k in range(MOST):
        if flags[where[k % where.shape[0]]] == 1:
            return True
    return False


def test_another_thread_runs_while_an_entry_kernel_does() -> None:
    flags, where = np.zeros(1, dtype=np.int64), np.zeros(1024, dtype=np.int64)
    flags[0] = 1
    assert seen(flags, where)
    flags[0] = 0
    other = Thread(target=flags.__setitem__, args=(0, 1))
    other.start()
    assert seen(flags, where)
    other.join()


def test_only_entry_kernels_let_go_of_the_lock() -> None:
    options = [one.targetoptions for one in (seen, total) if isinstance(one, KernelDispatcher)]
    assert [WITHOUT_LOCK.items() <= one.items() for one in options] == [True, False]


class Kept(NamedTuple):
    """What an arena holds."""

    numbers: Line
    places: IndexLine


@kernel
def total(addresses: np.ndarray) -> float:
    """Sum of the numbers of arenas (address, words), each of which also becomes 1."""
    found = 0.0
    for k in range(addresses.shape[0]):
        own = opened(words_at(addresses[k, 0], addresses[k, 1]), Kept)
        found += own.numbers.sum() + own.places.sum()
        own.numbers[:] = 1.0
    return found


@pytest.mark.nojit
def test_arenas_are_opened_by_their_addresses() -> None:
    arenas = [packed(Kept(np.arange(3.0) + k, np.array([k, 10 * k]))) for k in range(4)]
    addresses = np.array([[words.ctypes.data, len(words)] for words, _ in arenas])
    assert total(addresses) == sum(3.0 + 3.0 * k + 11.0 * k for k in range(4))
    assert all((kept.numbers == 1.0).all() for _, kept in arenas)
    assert words_at_all(np.array([[0, 0]])) == 0


@kernel
def words_at_all(addresses: np.ndarray) -> int:
    """How many words there are."""
    found = 0
    for k in range(addresses.shape[0]):
        found += words_at(addresses[k, 0], addresses[k, 1]).shape[0]
    return found
