"""Coefficients belong to pairs, in either order; the paper's Table 1 is the default."""


import pytest

from avatarsim.errors import UnknownName
from avatarsim.scene.body import TABLE_1, ContactLaw, PairTable


def test_pairs_read_the_same_in_either_order() -> None:
    for a in TABLE_1.names:
        for b in TABLE_1.names:
            assert TABLE_1.contact(a, b) == TABLE_1.contact(b, a)
    one = ContactLaw(0.5, 0.1)
    assert PairTable({("m", "n"): one, ("n", "m"): one}).contact("n", "m") == one


def test_table_1_is_the_papers() -> None:
    assert TABLE_1.names == ("human", "metal", "wood")
    assert TABLE_1.contact("human", "wood") == ContactLaw(0.2, 0.2)
    assert TABLE_1.contact("metal", "metal") == ContactLaw(0.3, 0.1)


def test_an_unknown_pair_is_named_and_the_known_ones_listed() -> None:
    table = PairTable({("ice", "ice"): ContactLaw(0.0, 0.0), ("ice", "wood"): ContactLaw(0.1, 0.0)})
    with pytest.raises(UnknownName) as error:
        table.contact("wood", "wood")
    assert "pair of materials" in str(error.value) and "wood, wood" in str(error.value) and "ice, wood" in str(error.value)
