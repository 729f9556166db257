"""What tests hand to kernels by reference is what they would have handed over by value."""

from typing import NamedTuple

import numpy as np
import pytest

from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.jit.by_reference import Reference
from avatarsim.jit.kernel import kernel
from avatarsim.jit.linking import KernelDispatcher
from tests.by_reference import KEPT, Lying, Referring

BY_VALUE = KernelDispatcher.__call__


class Inner(NamedTuple):
    flag: bool
    grid: np.ndarray
    flags: np.ndarray


class Outer(NamedTuple):
    count: int
    inner: Inner
    scratch: Scratch
    share: float
    line: np.ndarray


def outer(seed: int) -> Outer:
    rng = np.random.default_rng(seed)
    scratch = make_scratch()
    scratch.w[:] = rng.normal(size=scratch.w.shape)
    inner = Inner(bool(seed % 2), rng.normal(size=(2, 3)), rng.random(4) < 0.5)
    return Outer(int(rng.integers(9)), inner, scratch, float(rng.normal()), np.arange(5) + seed)


@kernel
def told(first: int, tree: Outer, by: tuple[float, float], row: np.ndarray) -> tuple[float, float]:
    """Something of every part; and the row is written to, and the grid."""
    found = tree.share * tree.count + by[0] * tree.inner.grid[1, 2] - by[1] * tree.scratch.w[2, 1]
    for k in range(first, len(tree.line)):
        row[k] += tree.line[k]
    tree.inner.grid[0, 1] += 1.0
    return found + (10.0 if tree.inner.flag else 20.0), 1.0 * tree.inner.flags.sum()


@kernel
def taken_apart(inner: Inner) -> float:
    """A reference has fields alone."""
    flag, grid, _ = inner
    return grid[0, 0] if flag else -1.0


def test_a_kernel_finds_and_leaves_the_same() -> None:
    referring = Referring(BY_VALUE)
    for seed in range(4):
        mine, twin, row, twin_row = outer(seed), outer(seed), np.zeros(5), np.zeros(5)
        for _ in range(2):
            found = referring.call(told, (1, mine, (0.5, 2.0), row))
            assert found == BY_VALUE(told, 1, twin, (0.5, 2.0), twin_row)
        assert row.tolist() == twin_row.tolist() and row.any()
        assert mine.inner.grid.tolist() == twin.inner.grid.tolist()
    (entry,) = referring.entries.values()
    assert entry is not None and len(entry.overloads) == 1, "it was by reference"


def test_what_was_laid_out_and_is_gone_is_no_other() -> None:
    """Numbers of tuples are given anew once one is gone; as many worlds as ever, and few of them are kept."""
    referring = Referring(BY_VALUE)
    for seed in range(3 * KEPT):
        tree = outer(seed)
        lying = referring.lying(tree)
        assert lying is referring.lying(tree) and lying.tree is tree and lying.kind is Reference(lying.kind.whole)
    assert len(referring.images) == KEPT


@pytest.mark.parametrize("part", [np.zeros((3, 2)).T, np.zeros(()), "text", None, np.int32(1)])
def test_what_no_image_holds_goes_by_value(part: object) -> None:
    with pytest.raises(TypeError, match="no image"):
        Lying(Inner(True, part, np.zeros(2, bool)))
    assert Referring(lambda kernel, inner: inner.flag).call(told, (Inner(True, part, np.zeros(2, bool)),)) is True


def test_a_kernel_that_takes_tuples_apart_gets_them_by_value() -> None:
    referring, inner = Referring(BY_VALUE), outer(1).inner
    for _ in range(2):
        assert referring.call(taken_apart, (inner,)) == inner.grid[0, 0]
    assert list(referring.entries.values()) == [None]
