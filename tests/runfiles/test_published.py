"""Results of a run keep to the published layout; the quick check agrees with the slow one."""

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
    st.none(), st.booleans(), st.integers(-3, 3), st.floats(allow_nan=False), st.sampled_from(["NaN", "Infinity", "pass", "x"]),
    st.lists(st.integers(), max_size=2),
)


def test_a_run_of_the_harness_keeps_to_the_schema() -> None:
    Draft202012Validator.check_schema(json.loads(SCHEMA.read_text()))
    check(json.loads(json.dumps(whole_run())), HERE)


CHANGED = st.tuples(
    st.integers(0, 20),
    st.dictionaries(st.sampled_from(["scenario", "status", "value", "bound", "seed", "note", "more"]), ODD, max_size=1),
)


@given(CHANGED, st.lists(ODD, max_size=6))
def test_the_quick_check_agrees_with_the_slow_one(row: tuple[int, dict[str, object]], numbers: list[object]) -> None:
    data = whole_run() | {"series": {"a": {"b/c": {"overlap_m": numbers}}}}
    rows = data["rows"]
    assert isinstance(rows, list)
    rows[row[0]] |= row[1]
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
