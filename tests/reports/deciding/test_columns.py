"""Several seeds show their worst; ratios never divide by zero and never rank what is not a number."""

import math

import pytest

from reports.deciding.columns import COLUMNS, ratio_to_best, truth_metric, worst
from reports.reading.load import Row
from reports.sections.unseen import LIMITS, MEASURES
from reports.words.metric_words import words
from runfiles.metrics import METRICS


def row(value: float | None, metric: str = "m", bound: float | None = None) -> Row:
    return Row("s", "e", "p", 0, 1, metric, value, "m", bound, None, "info", "")


@pytest.mark.parametrize(("values", "shown"), [([1.0, 3.0, 2.0], 3.0), ([None, 1.0], 1.0), ([None], None)])
def test_the_worst_seed_is_shown(values: list[float | None], shown: float | None) -> None:
    found = worst([row(value) for value in values])
    assert found is not None and found.value == shown


@pytest.mark.parametrize("broken", [math.nan, math.inf])
def test_a_broken_seed_outweighs_every_number(broken: float) -> None:
    for rows in ([row(broken), row(9.0)], [row(9.0), row(broken)]):
        found = worst(rows)
        assert found is not None and found.value is broken
    assert worst([]) is None


@pytest.mark.parametrize(("value", "best", "same", "expected"), [
    (2.0, 1.0, 0.0, 2.0), (0.0, 0.0, 0.0, 1.0), (5e-9, 0.0, 1e-8, 1.0), (1e-6, 0.0, 1e-8, math.inf), (0.5, 1.0, 0.0, 0.5),
    (None, 1.0, 0.0, None), (1.0, None, 0.0, None), (math.nan, 1.0, 0.0, None),
])
def test_ratio(value: float | None, best: float | None, same: float, expected: float | None) -> None:
    found = ratio_to_best(value, best, same)
    assert found == (None if expected is None else pytest.approx(expected))


def test_a_bounded_truth_ranks_the_scene() -> None:
    rows = [row(1.0, "apex_error_max"), row(2.0, "restitution_error_max", 0.1), row(3.0, "residual_overlap_max", 1e-6)]
    assert truth_metric(rows) == "restitution_error_max"
    assert truth_metric(rows[2:]) is None


def test_no_metric_belongs_to_two_columns() -> None:
    names = ("residual_overlap_max", "overlap_frames", "wrong_side_frames", "restitution_error_max", "tracker_offset_rms_free",
             "chatter_frames", "joint_limit_excess_max", "reach_cone_excess_max", "frame_time_p50",
             "frame_time_python_p50", "frame_time_p95")
    assert [sum(column.takes(name) for column in COLUMNS) for name in names] == [1] * len(names)


def test_a_column_of_one_metric_has_its_name_as_everywhere_on_the_page() -> None:
    """One name per quantity: limits of joints and reach cones are two, which no column mixes."""
    for key, metric in (("limits", "joint_limit_excess_max"), ("cone", "reach_cone_excess_max")):
        column = next(column for column in COLUMNS if column.key == key)
        assert column.title == words(metric) and [name for name in METRICS if column.takes(name)] == [metric]
    assert next(measure.title for measure in MEASURES if measure.metric == LIMITS) == words(LIMITS)
