"""Messages name the thing, the value and the valid range; of very many names those that were probably meant."""

import resource
from errno import ENOMEM

import numpy as np
import pytest

from avatarsim.errors import ALL_NAMED, LONGEST_VALUE, NEAREST, InvalidInput, UnknownName, described, ended_by, likely
from scenarios import catalog

MANY = [f"scene_{k}" for k in range(ALL_NAMED)] + ["two_arms", "two_arms_and_leg"]


def test_of_many_names_the_likely_ones_are_listed() -> None:
    assert str(UnknownName("engine", "bulet", ("pybullet", "mujoco"))).endswith("mujoco, pybullet")
    assert likely("x", MANY[:ALL_NAMED]).count(", ") == ALL_NAMED - 1
    assert likely("two_arm", MANY).startswith("two_arms, ")
    unlike = likely("zzz", MANY)
    assert unlike.count(", ") == NEAREST - 1 and str(len(MANY) - NEAREST) in unlike


def test_each_scene_is_found_by_its_name_without_a_letter() -> None:
    known = list(catalog.scenarios())
    for name in known:
        assert name in likely(name[:-1], known)


def test_a_long_value_is_cut_and_a_failing_repr_becomes_a_type() -> None:
    class Shy:
        def __repr__(self) -> str:
            raise RuntimeError

    said = str(InvalidInput("corners", list(range(10**5)), "few"))
    assert "[0, 1, 2" in said and "99999]" in said and len(said) < 2 * LONGEST_VALUE
    assert "Shy" in str(InvalidInput("thing", Shy(), "another"))


def large_array() -> object:
    return np.zeros((10**7, 10**6))


@pytest.mark.parametrize(("limit", "words"), [(600 * 2**20, ["0.63 GB", "ulimit -v"]), (resource.RLIM_INFINITY, ["the machine"])])
def test_a_lack_of_memory_names_size_place_and_limit(limit: int, words: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda which: (limit, limit))
    with pytest.raises(MemoryError) as caught:
        large_array()
    said = described(caught.value)
    assert said.startswith("MemoryError: ") and "(10000000, 1000000)" in said and "float64" in said
    assert [word for word in (f"{__name__}.large_array", *words) if word not in said] == []
    for error in (MemoryError(), OSError(ENOMEM, "Cannot allocate memory"), ImportError("x.so: failed to map segment")):
        assert [word for word in (type(error).__name__, *words) if word not in described(error)] == []
    assert described(ValueError("not\n  so")) == "ValueError: not so"
    assert "signal 6" in ended_by(-6) and ("ulimit -v" in ended_by(-6)) == (limit > 0)
