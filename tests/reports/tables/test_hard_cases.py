"""Summary of trials of hard cases against a count by hand."""

import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from reports.tables.hard_cases import by_case
from tests.reports.small_runs import MUJOCO, OURS, Part, write_study

figures = st.fixed_dictionaries({
    "residual_overlap_max": st.sampled_from((0.0, 1e-6, 2e-3)), "energy_added_max": st.sampled_from((0.0, 0.5, None)),
    "not_finite_frames": st.sampled_from((0.0, 0.0, 3.0)), "wrong_side_frames": st.sampled_from((0.0, 0.0, 2.0)),
    "end_distance": st.sampled_from((0.0, 1e-6, 0.5, None)),
})
part = st.builds(
    Part, st.sampled_from("ab"), st.sampled_from((OURS, MUJOCO)), st.sampled_from(("", "size 10", "start 1 m")), figures,
    status=st.sampled_from(("info", "info", "info", "crashed", "cannot-say")),
)


def most(values: list[float | None]) -> float:
    """Return the largest number; nan without one."""
    return max((value for value in values if value is not None), default=math.nan)


@given(st.lists(part, min_size=1, max_size=25, unique_by=lambda one: (one.scenario, one.run, one.change)))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_summary_is_that_of_a_count_by_hand(tmp_path: Path, parts: list[Part]) -> None:
    write_study(tmp_path, "hard_cases", *parts)
    table = by_case(tmp_path)
    assert table is not None
    found = {(row.case, row.run): row for row in table.itertuples()}
    assert set(found) == {(one.scenario, one.run) for one in parts}
    for (case, run), row in found.items():
        own = [one for one in parts if (one.scenario, one.run) == (case, run)]
        tried = [one for one in own if one.status == "info"]
        inside = [one for one in tried if one.figures["not_finite_frames"] == one.figures["wrong_side_frames"] == 0.0]
        assert row.trials == len(tried)
        assert row.not_finite == sum((one.figures["not_finite_frames"] or 0.0) > 0 for one in tried)
        assert row.left == sum((one.figures["wrong_side_frames"] or 0.0) > 0 for one in tried)
        anchored = any(one.change == "" for one in inside)
        expected = [
            most([one.figures["end_distance"] for one in inside]) if anchored else math.nan,
            most([one.figures["residual_overlap_max"] for one in inside]),
            most([one.figures["energy_added_max"] for one in inside]),
        ]
        assert [row.drift, row.overlap, row.energy] == pytest.approx(expected, nan_ok=True)
