"""The short forms of a run contain its verdict, its failures and its changes."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from reports import Judged, judged, terminal_summary
from reports.reading.load import EngineNote, Series
from reports.summaries.text import columns, engines, headline, markdown, terminal
from reports.tables.checks import checks
from reports.tables.losses import losses
from reports.tables.run import Run
from runfiles.table import Row, Status
from tests.reports.small_runs import BULLET, MUJOCO, OURS, OVERLAP, RAW, figure, run_of

Json = dict[str, object]
Write = Callable[[object], Path]


def both(run: Run) -> tuple[str, str]:
    """Return the texts of a run for a terminal and as Markdown."""
    found = Judged(run, checks(run), [], losses(run))
    return terminal(run, found.checks, [], found.losses), markdown(run, found.checks, [], found.losses, [])


def some(*statuses: Status) -> list[Row]:
    """Return a check per status, each in its own scene."""
    values = {"pass": 0.0, "waived": 1.5, "fail": 9.0}
    return [figure(f"scene_{k}", OURS, OVERLAP, values[one], one, 1.0, 2.0) for k, one in enumerate(statuses)]


@settings(max_examples=30)
@given(st.lists(st.sampled_from(["pass", "waived", "fail"]), min_size=1, max_size=9), st.booleans())
def test_a_headline_says_pass_only_of_a_sound_run(statuses: Sequence[Status], ended: bool) -> None:
    found = checks(run_of(some(*statuses), exit_code=0 if ended else None))
    words = headline(found).split()
    assert (words[0] == "PASS") == found.is_sound == ("fail" not in statuses and ended)
    assert str(len(statuses)) in words and (words[0] == "FAIL") == ("fail" in statuses)
    missing = checks(run_of([*some("pass"), figure("scene_0", MUJOCO, "run", None, "crashed", note="boom")]))
    assert headline(missing).split()[0] not in ("PASS", "FAIL")


def test_what_failed_is_named_in_every_form() -> None:
    deep = {"scene_1": {OURS: Series(np.array([0.0, 9.0, 0.0]), np.zeros(0))}}
    for text in both(run_of(some("pass", "fail", "waived", "pass"), deep, frame_times={"scene_1": 0.5})):
        assert "scene_1" in text and "scene_2" in text and "scenes/scene_1.html#t=0.5" in text


def test_the_table_has_a_row_per_engine_and_a_figure_per_column() -> None:
    rows = [figure("a", run, OVERLAP, 10.0**-k) for k, run in enumerate((OURS, MUJOCO, BULLET, RAW), 2)]
    run = run_of(rows)
    found = engines(run)
    assert len(found) == len(run.runs) == 4 and all(len(row) == 1 + len(columns(run)) for row in found)
    assert {row[1] for row in found} == {"10 mm", "1 mm", "100 µm", "10 µm"}
    # times of scenes with an avatar are excluded
    rows = [figure(scene, OURS, "frame_time_p95", time) for scene, time in (("a", 5.0), ("b", 500.0))]
    assert "5 µs" in engines(run_of([*rows, figure("b", OURS, "tracker_offset_rms", 0.0)]))[0]


def test_a_time_that_is_not_like_for_like_is_marked() -> None:
    def time(note: str) -> str:
        times = (("p50", 5.0), ("p95", 7.0))
        rows = [figure("a", run, f"frame_time_{name}", value, note=note) for run in (OURS, MUJOCO) for name, value in times]
        rows.append(figure("a", OURS, "resting_frames", 100.0 if note == "asleep" else 0.0))
        return engines(run_of(rows))[0][-1]

    assert time("") == "7 µs" and time("asleep") == "(7 µs)"
    # a tail of few frames does not compare engines, the median does
    assert time("3 x 90 frames") == "5 µs"


def test_said_is_the_summary_of_a_folder_and_names_what_changed(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    old, new = run_dir(results), run_dir(results | {"rows": [{**rows[0], "value": 1e-3}, *rows[1:]]})
    found = judged(new, old)
    assert terminal_summary(new, old) == terminal(found.run, found.checks, found.changes, found.losses)
    assert [one.count("worse") for one in found.changes] == [1] and old.name in terminal_summary(new, old)
    assert [one.count("worse") for one in judged(old, old).changes] == [0] and judged(old).changes == []


def test_the_table_tells_the_version_of_each_engine() -> None:
    versions = {MUJOCO: "3.17.0", "rapier/tuned": "0.36.1", RAW: "1"}
    notes = [EngineNote(run, "a", version, {}, {}) for run, version in versions.items()]
    run = run_of([figure("a", run, OVERLAP, 0.0) for run in (OURS, MUJOCO, "rapier/tuned", RAW)], notes=notes)
    assert run.versions == {"MuJoCo": "3.17.0", "Rapier": "0.36.1"}
    assert all(version in text for text in both(run) for version in ("3.17.0", "0.36.1"))
