"""Table 2 and Figures 7 and 8 of the paper: its figures as printed, and those of a run counted and timed as stated."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.__main__ import main
from benchmarks.table_2 import AS_PRINTED, PRINTED, figure_7, runs, table_2
from runfiles import record
from scenarios import catalog
from scenarios.catalog.paper import TABLE_2 as SCENES
from tests.scenarios.examples import recorded

FRAMES = 4


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """Two arms in both methods of ours and in another engine, everything where the user has it but for a bent joint."""
    scenario = catalog.get("two_arms")
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    held = recorded(scene, [scene.first_sample, *(motion(k) for k in range(FRAMES))])
    counts = {"joints": np.array([9, 4, 8, 0, 0]), "iterations": np.array([9, 1, 2, 0, 0]), "pairs": np.array([9, 2, 2, 0, 0]),
              "queries": np.array([9, 5, 5, 5, 5])}
    series = {}
    told_by = {"avatarsim/paper": counts, "avatarsim/default": {"iterations": counts["iterations"]}, "mujoco/tuned": {}}
    for who, told in told_by.items():
        one = replace(held, counts=told, meta=dict(held.meta) | {"full": True})
        if who == "avatarsim/default":
            orientations = held.orientations.copy()
            # the head alone turns against its parent, in half of the frames
            head = scene.names.index("human/neck")
            orientations[1:3, head] = np.roll(orientations[1:3, head], 1, axis=-1)
            one = replace(one, orientations=orientations)
        record.save(one, tmp_path / "recordings" / f"two_arms.{who.replace('/', '.')}.0.npz")
        series[who] = {"overlap_m": [0.0, 2e-7, 0.0], "frame_time_us": [10.0, 20.0, 30.0]}
    (tmp_path / "results.json").write_text(json.dumps({"series": {"two_arms": series}}))
    return tmp_path


def test_the_papers_rows_are_its_table() -> None:
    assert [line.scene for line in AS_PRINTED] == list(SCENES)
    assert [(p.frames, p.ms, p.joints, p.iterations, p.ik_share, p.pairs, p.collision_share) for p in AS_PRINTED] == [
        (1496, 14.63, 16, 3, 12.7, 3, 17.4), (2327, 15.99, 28, 5, 14.6, 5, 21.1),
        (2440, 17.47, 32, 6, 16.7, 6, 24.8), (2146, 20.49, 40, 7, 18.5, 13, 31.3),
    ]


def test_counts_are_of_frames_advanced_and_times_of_those_timed(run: Path) -> None:
    found = {line.run: line for line in table_2(runs(run))}
    assert list(found) == [PRINTED, "avatarsim/paper", "avatarsim/default", "mujoco/tuned"]
    paper = found["avatarsim/paper"]
    assert (paper.frames, paper.timed, paper.ms, paper.overlap) == (4, 3, 0.02, 2e-7)
    assert (paper.joints, paper.iterations, paper.pairs) == (3.0, 0.75, 1.0)
    other = found["mujoco/tuned"]
    assert other.ms == 0.02 and math.isnan(other.joints) and math.isnan(other.iterations)
    # no joint is counted: one is away from the user's in two of four frames
    default = found["avatarsim/default"]
    assert default.joints == 0.5 and default.iterations == 0.75 and math.isnan(default.pairs)


def test_every_frame_of_figure_7_has_a_time_and_shares() -> None:
    rows, shares = figure_7(frames=12, repeats=2)
    assert [(row.run, row.frame) for row in rows] == [
        (f"avatarsim/{preset}", k) for preset in ("default", "paper") for k in range(1, 13)
    ]
    assert all(row.us > 0.0 for row in rows) and "posture" in {row.stage for row in shares}
    for preset in ("default", "paper"):
        assert sum(row.share for row in shares if row.run == f"avatarsim/{preset}") == pytest.approx(100.0, abs=1.0)


def test_the_command_writes_table_and_traces(run: Path, tmp_path: Path) -> None:
    folder = tmp_path / "report"
    assert main(["table-2", "--of", str(run), "--run", str(folder), "--quick"]) == 0
    assert {path.name for path in folder.iterdir()} == {"table_2.csv", "figure_7.csv", "figure_7_shares.csv", "figure_8.csv"}
    lines = list(csv.DictReader((folder / "table_2.csv").read_text().splitlines()))
    assert [line["run"] for line in lines][:2] == [PRINTED, "avatarsim/paper"] and lines[1]["ik_share"] == ""
    trace = list(csv.DictReader((folder / "figure_8.csv").read_text().splitlines()))
    assert [line["run"] for line in trace] == ["avatarsim/paper"] * 3 + ["avatarsim/default"] * 3
    assert [(line["frame"], line["us"], line["iterations"]) for line in trace[:3]] == [
        ("1", "10", "1"), ("2", "20", "2"), ("3", "30", "0"),
    ]


def test_a_run_without_the_scenes_leaves_no_files(tmp_path: Path) -> None:
    (tmp_path / "results.json").write_text('{"series": {}}')
    assert main(["table-2", "--run", str(tmp_path)]) == 5 and main(["table-2", "--run", str(tmp_path / "nowhere")]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]


@pytest.mark.parametrize("content", ["", "[]", "{}", "[" * 100_000, '{"series": 3}', '{"series": {"two_arms": {"a/b": {}}}}',
                                     '{"series": {"two_arms": {"a/b": {"frame_time_us": [[]], "overlap_m": []}}}}'])
def test_results_that_are_damaged_are_refused(tmp_path: Path, content: str, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "results.json").write_text(content)
    assert main(["table-2", "--run", str(tmp_path)]) == 2
    assert "InvalidFile: results " in capsys.readouterr().err
