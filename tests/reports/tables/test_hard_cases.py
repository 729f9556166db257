"""Trials of hard cases, summed up, against a count by hand."""

import math
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reports.tables.hard_cases import by_case, trials
from tests.reports.small_runs import MUJOCO, OURS, write_trials

Trial = tuple[str, str, str, str, int, float, float, float]
trial = st.tuples(
    st.sampled_from("ab"),
    st.sampled_from((OURS, MUJOCO)),
    st.sampled_from(("plain", "dt", "scale")),
    st.sampled_from(("survived", "lost", "cannot-say", "not-measured")),
    st.integers(0, 2),
    *(st.sampled_from((0.0, 1e-6, 2e-3, 0.5, math.nan)) for _ in range(3)),
)
COLUMNS = ["case", "run", "kind", "state", "bad", "moved", "overlap", "energy"]


def most(values: list[float]) -> float:
    """The largest number; nan without one."""
    return max((value for value in values if value == value), default=math.nan)


@given(st.lists(trial, min_size=1, max_size=25))
def test_summary_is_that_of_a_count_by_hand(given_trials: list[Trial]) -> None:
    found = {(row.case, row.run): row for row in by_case(pd.DataFrame(given_trials, columns=COLUMNS)).itertuples()}
    assert set(found) == {one[:2] for one in given_trials}
    for key, row in found.items():
        part = [one for one in given_trials if one[:2] == key]
        survived, lost = [one for one in part if one[3] == "survived"], [one for one in part if one[3] == "lost"]
        plain = [one[3] for one in survived + lost if one[2] == "plain"]
        assert (row.trials, row.unsupported) == (len(survived) + len(lost), len(part) - len(survived) - len(lost))
        assert (row.not_finite, row.left) == (sum(one[4] > 0 for one in lost), sum(one[4] == 0 for one in lost))
        anchored = bool(plain) and "lost" not in plain
        drift = most([one[5] for one in survived]) if anchored else math.nan
        expected = [drift, most([one[6] for one in survived]), most([one[7] for one in survived])]
        assert [row.drift, row.overlap, row.energy] == pytest.approx(expected, nan_ok=True)


def test_a_file_is_read_as_written(tmp_path: Path) -> None:
    write_trials(tmp_path, {"kind": "plain", "overlap": 1e-7}, {"moved": 2e-3}, {"case": "pile", "state": "lost", "bad": 2})
    table = trials(tmp_path)
    assert table is not None and len(table) == 3
    rows = {row.case: row for row in by_case(table).itertuples()}
    assert (rows["stack"].drift, rows["stack"].overlap, rows["stack"].trials) == (2e-3, 1e-7, 2)
    assert rows["pile"].not_finite == 1 and math.isnan(rows["pile"].drift)
