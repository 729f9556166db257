"""No factor is made of a time in which one engine sleeps, and the page of a scene says which do, and what moving frames take."""

import copy
from collections.abc import Callable
from pathlib import Path

import pytest

from reports import write_report
from reports.deciding.alike import RESTING, asleep, sleepers
from reports.deciding.columns import COLUMNS
from reports.deciding.conclusions import asleep_sentence
from reports.deciding.tables import blocks
from reports.reading.load import load
from tests.reports.conftest import row

Json = dict[str, object]
Write = Callable[[object], Path]
OURS, AWAKE, TOLD = "avatarsim/default", "mujoco/tuned", "mujoco/sleeping"
P50, P95 = (next(k for k, column in enumerate(COLUMNS) if column.key == key) for key in ("p50", "p95"))


def run_of(results: Json, rests: float, told: bool = True) -> Json:
    """Three runs in a scene in which all rests in that share of frames [%]; the third is told to sleep."""
    data = copy.deepcopy(results)
    times = {OURS: (0.4, 1000.0), AWAKE: (650.0, 660.0), TOLD: (37.0, 560.0)}
    rows = [row("stack", run, f"frame_time_{name}", value, "us") for run, both in times.items()
            for name, value in zip(("p50", "p95"), both, strict=True)]
    rows += [row("stack", run, RESTING, rests, "%") for run in times]
    said = {"name": "mujoco", "version": "1", "preset": "sleeping", "scenario": "stack", "cannot_say": {},
            "settings": {"sleep": [told, "a flag"]}}
    return data | {"rows": [*list(data["rows"]), *rows], "engines": [*list(data["engines"]), said]}  # type: ignore[call-overload]


@pytest.mark.parametrize(("rests", "sleeping"), [(49.0, ()), (50.0, ("p50",)), (94.0, ("p50",)), (95.0, ("p50", "p95"))])
def test_a_time_in_which_one_sleeps_has_neither_factor_nor_best(
    run_dir: Write, results: Json, rests: float, sleeping: tuple[str, ...],
) -> None:
    found = load(run_dir(run_of(results, rests)))
    (stack,) = (block for block in blocks(found) if block.scene == "stack")
    for key, place in (("p50", P50), ("p95", P95)):
        cells = {line.run: line.cells[place] for line in stack.lines}
        assert all((cell.ratio is None and not cell.best) is (key in sleeping) for cell in (cells[OURS], cells[TOLD]))
    assert stack.asleep == ((OURS, TOLD) if "p50" in sleeping else ())
    assert (asleep_sentence(stack) == "") is ("p50" not in sleeping)


def test_who_is_told_to_sleep_and_is_not_told_apart(run_dir: Write, results: Json) -> None:
    assert set(sleepers(load(run_dir(run_of(results, 80.0))))["stack"]) == {OURS, TOLD}
    awake = sleepers(load(run_dir(run_of(results, 80.0, told=False))))["stack"]
    assert set(awake) == {OURS} and asleep(awake, "p50") == (OURS,) and asleep(awake, "overlap") == ()


def test_the_page_of_the_scene_says_it(run_dir: Write, results: Json) -> None:
    folder = run_dir(run_of(results, 80.0))
    write_report(folder)
    page = (folder / "scenes" / "stack.html").read_text(encoding="utf-8")
    assert (f"In the median frame both sleep: {OURS} 400 ns, {TOLD} 37.0 µs; no factor is made of medians here. In frames that "
            f"move (95th percentile): {OURS} 1.00 ms, {TOLD} 560 µs, {AWAKE} 660 µs.") in page
