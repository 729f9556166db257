"""A tally equals the dictionary of its names and numbers."""

import pickle

import numpy as np
import pytest

from avatarsim.counters import Tally

NAMES, NUMBERS = ("queries", "steps", "held"), [3, 0, 7]


def test_it_is_the_dictionary_that_it_is_not_filled_into() -> None:
    tally, twin = Tally(NAMES, NUMBERS), dict(zip(NAMES, NUMBERS, strict=True))
    assert tally == twin and dict(tally) == twin and list(tally) == list(twin) and len(tally) == 3
    assert list(tally.items()) == list(twin.items()) and list(tally.values()) == NUMBERS and repr(tally) == repr(twin)
    assert "held" in tally and tally["held"] == 7 and tally.get("pairs", 0) == 0 and "pairs" not in tally
    with pytest.raises(KeyError, match="pairs"):
        tally["pairs"]
    assert not Tally() and Tally() == {} and pickle.loads(pickle.dumps(tally)) == tally


def test_two_stand_beside_each_other() -> None:
    both = Tally(NAMES, NUMBERS).joined_with(Tally(("islands",), [2]), (*NAMES, "islands"))
    assert both == {"queries": 3, "steps": 0, "held": 7, "islands": 2}


def test_the_bytes_of_an_array_are_its_numbers() -> None:
    """Later changes of the array are not counted."""
    counted = np.array(NUMBERS)
    tally = Tally(NAMES, counted.tobytes())
    counted[:] = 0
    assert tally == Tally(NAMES, NUMBERS) and tally["held"] == 7
