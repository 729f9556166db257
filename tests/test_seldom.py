"""A hint to the compiler changes no answer."""

import pytest

from avatarsim.kernel import kernel
from avatarsim.seldom import seldom


@kernel
def root_above(x: float, least: float) -> float:
    """The square root of x if x is larger than least, else x."""
    if seldom(x > least):
        x = x**0.5
    return x


@pytest.mark.nojit
@pytest.mark.parametrize(("x", "found"), [(4.0, 2.0), (1.0, 1.0), (-1.0, -1.0)])
def test_the_condition_is_what_it_was(x: float, found: float) -> None:
    assert root_above(x, 1.0) == found
    assert seldom(x > 1.0) == (x > 1.0)
