"""Every chart is a valid Vega-Lite specification, with colours of both themes."""

import json
import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import vl_convert
from hypothesis import given
from hypothesis import strategies as st

from reports.charts import cells, curves, marks, strips
from reports.pages.scripts import data, source
from reports.tables.effects import effects
from reports.tables.hard_cases import by_case
from reports.tables.losses import losses
from reports.tables.run import Run
from runfiles.comparable import FEW_FRAMES
from runfiles.engines import about
from tests.reports.small_runs import BULLET, MUJOCO, OURS, OVERLAP, RAW, figure, run_of, write_all

values = st.none() | st.sampled_from([math.nan, math.inf, -math.inf]) | st.floats(-1.0, 1e9)
RUNS = (OURS, MUJOCO, BULLET, RAW, "newcomer/fast")
TOKEN = re.compile(r"@(\w+)")


def run(worst: float | None = 2e-3) -> Run:
    """Return a run with each metric of the strips in five engines; the last has the worst value."""
    rows = [figure("a", one, chart.metric, 0.1 * k) for chart in strips.STRIPS.values() for k, one in enumerate(RUNS)]
    return run_of([*rows, figure("b", OURS, OVERLAP, worst, "fail", 1e-6), figure("b", MUJOCO, OVERLAP, 0.0)])


def over_time(lines: Mapping[str, tuple[np.ndarray, np.ndarray]], unit: str, floor: float | None = None) -> marks.Spec:
    """Return lines over time with the data that the page builds from their columns."""
    spec = curves.over_time(lines, curves.dashes(list(lines)), unit, "some words", floor)
    columns = spec["usermeta"]["lines"].items()
    rows = [{"t": t, "v": v, "run": run} for run, one in columns for t, v in zip(one["t"], one["v"], strict=True)]
    return spec | {"datasets": {"lines": rows}}


def specifications(folder: Path) -> dict[str, marks.Spec]:
    """Return one specification of every chart."""
    made = run()
    write_all(folder)
    table, switched = by_case(folder), effects(folder)
    assert table is not None and switched is not None
    times = np.arange(5.0)
    return {
        **{name: strips.strip(made, chart, "some words") for name, chart in strips.STRIPS.items()},
        "settings": curves.error_against_time(["avatarsim", "mujoco"]),
        "time": over_time({OURS: (times, times), MUJOCO: (times, times**2)}, "us", 0.1),
        "energy": over_time({OURS: (times, times), "avatarsim/paper": (times, -times)}, "J"),
        "hard": cells.hard_cases(made, table), "effects": cells.effects(switched), "losses": cells.bars(losses(made)),
    }


def texts(part: Any) -> Iterator[str]:
    """Yield all texts in a specification except those of its data."""
    if isinstance(part, str):
        yield part
    elif isinstance(part, Mapping):
        for name, one in part.items():
            yield from () if name in ("values", "datasets", "usermeta") else texts(one)
    elif isinstance(part, list):
        for one in part:
            yield from texts(one)


@pytest.mark.parametrize("drift", [0.0, math.nan, math.inf, 1e300])
def test_hard_cases_have_finite_shades(tmp_path: Path, drift: float) -> None:
    write_all(tmp_path)
    table = by_case(tmp_path)
    assert table is not None
    spec = cells.hard_cases(run(), table.assign(drift=drift))
    assert all(math.isfinite(cell["shade"]) for cell in spec["data"]["values"])


def test_every_chart_can_be_drawn_in_both_themes(tmp_path: Path) -> None:
    palettes = marks.palette(["newcomer"])
    for name, spec in specifications(tmp_path).items():
        for colours in palettes.values():
            drawn = marks.coloured(spec, colours) | {"width": 200}
            svg = vl_convert.vegalite_to_svg(json.dumps(drawn))
            assert svg.startswith("<svg") and not TOKEN.search("".join(texts(drawn))), name


def test_colours_are_tokens_of_the_palette(tmp_path: Path) -> None:
    palettes = marks.palette(["newcomer"])
    seen = set(re.findall(r'"@(\w+)"', "".join(map(source, ("theme.js", "index.js", "scene.js")))))
    for name, spec in specifications(tmp_path).items():
        seen |= {found[1] for text in texts(spec) if (found := TOKEN.fullmatch(text))}
        assert not {text for text in texts(spec) if re.fullmatch(r"#[0-9a-fA-F]{3,8}", text)} - {"#ffffff"}, name
    assert {"avatarsim", "mujoco", "ink", "muted"} <= seen
    assert all(seen <= set(colours) for colours in palettes.values())
    light, dark = palettes.values()
    made = about("newcomer")
    assert set(light) == set(dark) and (light["newcomer"], dark["newcomer"]) == (made.colour, made.dark)
    assert all(re.fullmatch(r"#[0-9a-f]{6}", colour) for colour in [*light.values(), *dark.values()])


@given(values)
def test_a_strip_holds_whatever_an_engine_shows(value: float | None) -> None:
    spec = strips.strip(run(value), strips.STRIPS["overlap"], "some words")
    json.loads(data(spec))
    low, high = strips.STRIPS["overlap"].low, strips.STRIPS["overlap"].high
    dots = spec["data"]["values"]
    assert len(dots) == len(RUNS) + 1 + (value is not None) and all(low <= dot["value"] <= high for dot in dots)


@given(st.lists(st.sampled_from([math.nan, math.inf, 0.0, 1e-9, 3.0]), min_size=1, max_size=20), st.sampled_from([None, 1e-9]))
def test_a_line_over_time_holds_whatever_an_engine_shows(found: list[float], floor: float | None) -> None:
    spec = over_time({MUJOCO: (np.arange(len(found)) / 60.0, np.array(found))}, "m", floor)
    kept = json.loads(data(spec))["datasets"]["lines"]
    assert [point["v"] for point in kept] == [max(one, floor or 0.0) for one in found if math.isfinite(one)]


@given(st.integers(1, 2000), st.data())
def test_the_largest_value_survives_thinning(count: int, draw: st.DataObject) -> None:
    peak = draw.draw(st.integers(0, count - 1))
    line = np.zeros(count)
    line[peak] = 7.0
    kept = over_time({OURS: (np.arange(count) / 60.0, line)}, "m")["datasets"]["lines"]
    assert [point["t"] for point in kept if point["v"] == 7.0] == pytest.approx([peak / 60.0], rel=1e-4)
    assert len(kept) <= curves.POINTS


def test_a_preset_has_the_same_line_on_every_page() -> None:
    tuned, default = MUJOCO, "mujoco/default"
    whole = curves.dashes([default, OURS, tuned, "newcomer/fast"])
    assert whole[OURS] == whole[tuned] == whole["newcomer/fast"] != whole[default]
    assert all(curves.dashes([run]) == {run: whole[run]} for run in whole)


def test_a_dot_is_hollow_where_the_table_says_that_it_does_not_compare() -> None:
    """A tail of few frames does not; the chart of times then has the median, which does."""
    both, few = (OURS, MUJOCO), "3 x 90 frames"
    made = run_of([figure("a", one, f"frame_time_{name}", 1.0, note=few) for one in both for name in ("p50", "p95")])
    for chart, even in ((strips.STRIPS["time"], False), (strips.strips(made)["time"], True)):
        values = strips.strip(made, chart, "x")["data"]["values"]
        why = "yes" if even else f"no; {FEW_FRAMES}"
        assert [(dot["even"], dot["counted"], dot["why"]) for dot in values] == [(even, even, why)] * 2
    many = run_of([figure("a", one, "frame_time_p95", 1.0, note="3 x 200 frames") for one in both])
    assert strips.strips(many) is strips.STRIPS
