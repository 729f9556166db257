"""Coefficients belong to pairs, in either order; the paper's Table 1 is the default."""

import math

import pytest

from avatarsim.errors import InvalidScene, UnknownName
from avatarsim.scene.body import TABLE_1, ContactLaw, PairTable


def test_pairs_read_the_same_in_either_order() -> None:
    for a in TABLE_1.names:
        for b in TABLE_1.names:
            assert TABLE_1.contact(a, b) == TABLE_1.contact(b, a)


def test_table_1_is_the_papers() -> None:
    assert TABLE_1.names == ("human", "metal", "wood")
    assert TABLE_1.contact("human", "wood") == ContactLaw(0.2, 0.2)
    assert TABLE_1.contact("metal", "metal") == ContactLaw(0.3, 0.1)


@pytest.mark.parametrize("value", [-0.01, 1.01, math.nan, math.inf])
def test_restitution_is_from_0_to_1(value: float) -> None:
    with pytest.raises(InvalidScene, match="restitution is .* from 0 to 1"):
        ContactLaw(value, 0.1)


@pytest.mark.parametrize("value", [-0.01, math.nan, math.inf])
def test_friction_is_finite_and_not_negative(value: float) -> None:
    with pytest.raises(InvalidScene, match="friction is .* from 0 to 100"):
        ContactLaw(0.1, value)


def test_an_unknown_pair_is_named_and_the_known_ones_listed() -> None:
    table = PairTable({("ice", "ice"): ContactLaw(0.0, 0.0), ("ice", "wood"): ContactLaw(0.1, 0.0)})
    with pytest.raises(UnknownName) as error:
        table.contact("wood", "wood")
    assert "pair of materials" in str(error.value) and "wood, wood" in str(error.value) and "ice, wood" in str(error.value)


def test_a_pair_given_both_ways_says_the_same_both_times() -> None:
    """Whichever came last would win, and no message would tell."""
    one, other = ContactLaw(0.5, 0.1), ContactLaw(0.5, 0.2)
    assert PairTable({("m", "n"): one, ("n", "m"): one}).contact("n", "m") == one
    with pytest.raises(InvalidScene, match=r"contact of n and m is .*0\.2.*; valid: that of m and n, .*0\.1"):
        PairTable({("m", "n"): one, ("n", "m"): other})
