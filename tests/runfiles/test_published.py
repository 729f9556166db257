"""What a run writes keeps to the published layout; the quick check finds what the slow one finds."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from avatarsim.errors import InvalidFile
from runfiles.published import SCHEMA, check
from tests.reports.conftest import whole_run

HERE = Path("results.json")
ODD: st.SearchStrategy[object] = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 3),
    st.floats(allow_nan=False),
    st.sampled_from(["NaN", "Infinity", "pass", "x"]),
    st.lists(st.integers(), max_size=2),
)


def test_the_schema_itself_is_sound() -> None:
    Draft202012Validator.check_schema(json.loads(SCHEMA.read_text()))


def test_a_run_of_the_harness_keeps_to_it() -> None:
    check(json.loads(json.dumps(whole_run())), HERE)


@given(st.integers(0, 20), st.sampled_from(["scenario", "status", "value", "bound", "seed", "note", "more"]), ODD)
def test_the_quick_check_agrees_with_the_slow_one(index: int, key: str, odd: object) -> None:
    data = whole_run()
    rows = data["rows"]
    assert isinstance(rows, list)
    rows[index] |= {key: odd}
    slow = Draft202012Validator(json.loads(SCHEMA.read_text())).is_valid(data)
    try:
        check(data, HERE)
        quick = True
    except InvalidFile:
        quick = False
    assert quick == slow


@given(st.lists(ODD, max_size=6))
def test_series_agree_too(numbers: list[object]) -> None:
    data = whole_run() | {"series": {"a": {"b/c": {"overlap_m": numbers}}}}
    slow = Draft202012Validator(json.loads(SCHEMA.read_text())).is_valid(data)
    try:
        check(data, HERE)
        quick = True
    except InvalidFile:
        quick = False
    assert quick == slow


@pytest.mark.parametrize(
    ("change", "where"),
    [
        (lambda data: data.pop("rows"), "top level"),
        (lambda data: data.update(exit_code=4), "exit_code"),
        (lambda data: data["series"]["arm_wall"].update({"a/b": []}), "series.arm_wall.a/b"),
    ],
)
def test_the_place_is_named(change: Callable[[dict[str, object]], object], where: str) -> None:
    data = whole_run()
    change(data)
    with pytest.raises(InvalidFile, match=f"^{where}"):
        check(data, HERE)
