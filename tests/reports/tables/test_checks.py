"""Every check has one outcome, determined by its numbers."""

import math
from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reports.tables.checks import Checks, checks, least_room
from runfiles.table import Row, Status
from tests.reports.small_runs import MUJOCO, OURS, OVERLAP, figure, run_of

values = st.sampled_from([-1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0, math.nan, math.inf, -math.inf])
limits = st.tuples(st.sampled_from([0.0, 1.0]), st.none() | st.sampled_from([1.0, 2.0]))
gated = st.lists(st.tuples(values, limits), min_size=1, max_size=9)


def outcome(value: float, bound: float, ceiling: float | None) -> Status:
    """Return the outcome by definition: a pass needs a finite value within its bound."""
    if math.isfinite(value) and value <= bound:
        return "pass"
    return "waived" if math.isfinite(value) and ceiling is not None and value <= ceiling else "fail"


@given(gated)
def test_outcomes_are_those_of_the_definition(given_rows: Sequence[tuple[float, tuple[float, float | None]]]) -> None:
    told = [outcome(value, bound, ceiling) for value, (bound, ceiling) in given_rows]
    rows = [
        figure(f"s{k}", OURS, OVERLAP, value, one, bound, ceiling)
        for k, ((value, (bound, ceiling)), one) in enumerate(zip(given_rows, told, strict=True))
    ]
    found = checks(run_of(rows))
    for name, part in (("pass", found.passed), ("waived", found.waived), ("fail", found.failed)):
        assert set(part.scenario) == {f"s{k}" for k, one in enumerate(told) if one == name}
    assert found.total == len(rows) and found.is_sound == ("fail" not in told)


def test_a_status_is_not_believed_against_its_number() -> None:
    found = checks(run_of([figure("a", OURS, OVERLAP, 2.0, "pass", 1.0), figure("b", OURS, OVERLAP, 0.5, "fail", 1.0)]))
    assert list(found.failed.scenario) == ["a"] and list(found.passed.scenario) == ["b"]


def test_failures_stand_in_the_order_of_their_excess() -> None:
    pairs = {"a": (2.0, 1.0), "b": (9.0, 3.0), "c": (math.nan, 1.0), "d": (1.0, 0.0)}
    rows = [figure(name, OURS, OVERLAP, value, "fail", bound) for name, (value, bound) in pairs.items()]
    order = list(checks(run_of(rows)).failed.scenario)
    assert set(order[:2]) == {"c", "d"} and order[2:] == ["b", "a"]


def sound(*more: Row, exit_code: int | None = 0) -> Checks:
    """Return the checks of a run with one pass and these rows."""
    return checks(run_of([figure("a", OURS, OVERLAP, 0.0, "pass", 1.0), *more], exit_code=exit_code))


@pytest.mark.parametrize(("more", "part"), [
    (figure("b", OURS, "run", None, "crashed", seed=1), "crashed"),
    (figure("b", MUJOCO, "run", None, "crashed", seed=1), "crashed"),
    (figure("b", OURS, "run", None, "not-measured", seed=1), "unmeasured"),
    (figure("b", MUJOCO, "run", None, "not-measured", seed=1), "unmeasured"),
    (figure("b", OURS, OVERLAP, None, "info", 1.0), "unmeasured"),
    (figure("b", MUJOCO, OVERLAP, 0.0), "unmeasured"),
    (figure("b", OURS, OVERLAP, None, "fail", 1.0), "failed"),
    (figure("b", OURS, "run", None, "refused"), "refused"),
])
def test_a_row_without_a_figure_has_its_part(more: Row, part: str) -> None:
    """A scene that the gated engine never ran is missing; an expected refusal is not a fault."""
    found = sound(more)
    assert "b" in set(getattr(found, part).scenario)
    assert found.is_sound == (part == "refused")


def test_sound_run_has_ended_and_checked_the_gated_engine() -> None:
    assert sound().is_sound and not sound(exit_code=None).is_sound
    assert sound(figure("a", MUJOCO, OVERLAP, 9.0, "info", 1.0)).total == 1
    found = checks(run_of([figure("a", OURS, OVERLAP, 0.0)]))
    assert found.total == 0 and not found.is_sound


@settings(max_examples=30)
@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8, unique=True))
def test_least_room_is_what_is_nearest_to_its_bound(shares: Sequence[float]) -> None:
    rows = [figure(f"s{k}", OURS, OVERLAP, share * (k + 1.0), "pass", k + 1.0) for k, share in enumerate(shares)]
    found = least_room(checks(run_of(rows)))
    assert found.room.tolist() == pytest.approx(sorted(shares, reverse=True)[:3])
