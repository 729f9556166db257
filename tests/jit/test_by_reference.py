"""A named tuple by reference reads, nests and changes its arrays as the tuple itself does."""

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from avatarsim.jit.by_reference import refer
from avatarsim.jit.kernel import config, kernel

pytestmark = pytest.mark.nojit


class Inner(NamedTuple):
    """Arrays of all kinds that kernels use."""

    real: NDArray[np.float64]
    flags: NDArray[np.bool_]
    whole: NDArray[np.int64]


class Alike(NamedTuple):
    """Fields of one type: numba keeps these apart from other tuples."""

    x: float
    y: float


class Outer(NamedTuple):
    """A tuple in a tuple, and numbers."""

    factor: float
    inner: Inner
    alike: Alike
    on: bool
    count: int  # type: ignore[assignment]


@kernel
def deep(inner: Inner, k: int) -> float:
    """Read and write through an argument that may be a reference."""
    inner.flags[k] = not inner.flags[k]
    inner.whole[k, 1] += k
    inner.real[k] *= 2.0
    return inner.real[k] + inner.real.shape[0]


@kernel
def made(x: float) -> Alike:
    """Return a tuple that a kernel returns."""
    return Alike(x, 1.0)


@kernel
def kept_apart(n: int) -> float:
    """Each result of a call is referred to by itself, and none follows its variable."""
    first, second = refer(made(1.0)), refer(made(20.0))
    changing = made(300.0)
    third = refer(changing)
    for k in range(n):
        changing = made(1000.0 * k)
    total = 0.0
    for k in range(n):
        total += refer(made(10000.0 * k)).x
    return first.x + second.x + third.x + changing.x + total


@kernel
def body(outer: Outer) -> float:
    """Something with every field, in a loop, with the inner tuple passed on."""
    total = outer.alike.x - outer.alike.y
    for k in range(outer.count):
        inner = refer(outer.inner)
        total += deep(inner, k) * outer.factor
    return total if outer.on else -total


@kernel
def by_reference(outer: Outer) -> float:
    """Twice by reference is once."""
    return body(refer(refer(outer)))


def sample(count, factor, on):
    rng = np.random.default_rng(count)
    inner = Inner(rng.normal(size=count), rng.random(count) < 0.5, rng.integers(-5, 5, (count, 2)))
    return Outer(factor, inner, Alike(factor, 3.0 * factor), on, count)


@given(st.integers(0, 9), st.floats(-1e3, 1e3), st.booleans())
def test_a_reference_does_what_the_tuple_does(count, factor, on):
    ours, twin = sample(count, factor, on), sample(count, factor, on)
    assert by_reference(ours) == body(twin)
    for left, right in zip(ours.inner, twin.inner, strict=True):
        assert np.array_equal(left, right)


def test_only_a_named_tuple_is_referred_to():
    @kernel
    def of_a_number(x: float) -> float:
        return refer(x)

    if config.DISABLE_JIT:
        assert of_a_number(1.0) == 1.0  # nothing is compiled, and nothing passed
    else:
        with pytest.raises(Exception, match="refer"):
            of_a_number(1.0)


def test_refers_to_what_each_call_of_a_kernel_returned() -> None:
    assert kept_apart(3) == 1.0 + 20.0 + 300.0 + 2000.0 + 30000.0
