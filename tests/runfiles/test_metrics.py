"""Every figure that a run writes is one entry of the registry."""

import ast
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.errors import UnknownName
from runfiles.metrics import FAMILIES, METRICS, RANKED, Metric, metric, unit

ROOT = Path(__file__).parents[2]
UNITS = {"m", "us", "s", "deg", "rad", "rad/s", "m/s", "m/s^2", "%", "", "frames", "J", "N", "bodies", "towers"}
ENDINGS = "max|mean|p50|p95|p99|rms|end|missing|frames|error|fallen|bodies|free"
values = st.floats(min_value=0.0, max_value=1e6, allow_nan=False)


def written() -> set[str]:
    """Return names in the sources of all measures that end as names of metrics do."""
    found = set()
    for path in (ROOT / "scenarios" / "measure").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                if re.fullmatch(rf"[a-z0-9]+(_[a-z0-9]+)*_({ENDINGS})", node.value):
                    found.add(node.value)
    return found


def test_every_measure_is_registered() -> None:
    found = written()
    assert len(found) > 50
    for name in found:
        assert metric(name).name == name


@pytest.mark.parametrize("name", ["stage_share_posture", "joints_per_frame", "stage_share_", "iterations_per_frame"])
def test_a_name_of_a_family_is_found(name: str) -> None:
    assert metric(name) in FAMILIES and unit(name) == metric(name).unit and name not in METRICS


@pytest.mark.parametrize("name", ["", "no_such_metric", "residual_overlap", "per_frame_joints", "run ", "stage_shares"])
def test_an_unknown_name_is_an_error_that_names_it(name: str) -> None:
    with pytest.raises(UnknownName) as error:
        unit(name)
    assert error.value.value == name


def test_metrics_have_known_units_and_a_level_or_a_reason() -> None:
    """None is also in a family."""
    assert {one.unit for one in (*METRICS.values(), *FAMILIES)} <= UNITS
    assert not [name for name in METRICS for one in FAMILIES if name.startswith(one.name) or name.endswith(one.name)]
    assert len(RANKED) > 20
    for one in METRICS.values():
        if one.name in RANKED:
            assert one.level is not None and one.level >= 0.0 and 0.0 <= one.share < 1.0 and not one.unranked
        else:
            assert one.level is None and one.unranked
    assert all(one.level is None and one.unranked for one in FAMILIES)
    assert all(one.name in RANKED for one in METRICS.values() if one.watched or one.inside)


@given(values, values, st.floats(0.0, 0.5), st.floats(0.0, 10.0))
def test_of_two_values_at_most_one_is_better(one: float, other: float, share: float, level: float) -> None:
    entry = Metric("some", "m", "some", "some", "some", level, share)
    assert not (entry.better(one, other) and entry.better(other, one)) and not entry.better(one, one)
    if entry.better(one, other):
        assert other - one > level * (1.0 - 1e-9) and (one == 0.0 or other / one > 1.0 + share * (1.0 - 1e-9))
        assert entry.better(one, 2.0 * other)


@pytest.mark.parametrize("entry", RANKED.values(), ids=RANKED)
def test_values_within_the_level_or_the_share_are_equal(entry: Metric) -> None:
    level, large = entry.level or 0.0, 1e3 * (entry.level or 1.0)
    assert not entry.better(0.0, 0.9 * level) and entry.better(0.0, 1.1 * level + 1e-300)
    near, far = large * (1.0 + entry.share) * 0.9999, (large + level) * (1.0 + entry.share) * 1.0001
    assert entry.better(large, far) and (not entry.share or not entry.better(large, near))


def test_nan_is_never_better_and_any_number_is_better() -> None:
    entry, nan = METRICS["residual_overlap_max"], float("nan")
    assert not entry.better(nan, 0.0) and not entry.better(nan, nan)
    assert entry.better(1e9, nan) and entry.better(1.0, float("inf"))
    assert not METRICS["run"].better(0.0, 1.0)
