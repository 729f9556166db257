"""Table 2 from a run's files: the paper's figures as printed, and ours counted and timed as stated."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from reference.frame_shares.measure import Shares
from runfiles import record
from scenarios import catalog
from scenarios.table_2 import rows as module
from scenarios.table_2.__main__ import main, table, written
from scenarios.table_2.printed import SCENES
from scenarios.table_2.rows import AS_PRINTED, PRINTED, row, rows, runs
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
    tail = {"scenario": "two_arms", "engine": "avatarsim", "metric": "frame_time_p99", "seed": 0}
    tails = [tail | {"preset": "paper", "value": 55.0}, tail | {"preset": "default", "value": None}]
    (tmp_path / "results.json").write_text(json.dumps({"series": {"two_arms": series}, "rows": tails}))
    return tmp_path


def test_the_papers_rows_are_its_table() -> None:
    assert [line.scene for line in AS_PRINTED] == list(SCENES)
    assert [(p.frames, p.ms, p.joints, p.iterations, p.ik_share, p.pairs, p.collision_share) for p in AS_PRINTED] == [
        (1496, 14.63, 16, 3, 12.7, 3, 17.4), (2327, 15.99, 28, 5, 14.6, 5, 21.1),
        (2440, 17.47, 32, 6, 16.7, 6, 24.8), (2146, 20.49, 40, 7, 18.5, 13, 31.3),
    ]


def test_counts_are_means_over_all_frames_advanced_and_times_over_those_timed(run: Path) -> None:
    found = {line.run: line for line in rows(run, clocks=False)}
    assert list(found) == [PRINTED, "avatarsim/paper", "avatarsim/default", "mujoco/tuned"]
    ours = found["avatarsim/paper"]
    assert (ours.frames, ours.timed, ours.ms, ours.p50, ours.overlap) == (4, 3, 0.02, 20.0, 2e-7)
    assert (ours.joints, ours.iterations, ours.pairs, ours.queries) == (3.0, 0.75, 1.0, 5.0)
    # of all frames that it had by itself; where a run says that those were too few, there is none
    assert ours.p99 == 55.0 and math.isnan(found["avatarsim/default"].p99) and math.isnan(found["mujoco/tuned"].p99)
    assert math.isnan(ours.ik_share)
    other = found["mujoco/tuned"]
    assert other.ms == 0.02 and math.isnan(other.joints) and math.isnan(other.iterations)


def test_where_no_joint_is_counted_those_away_from_the_user_are(run: Path) -> None:
    ours = next(line for line in rows(run, clocks=False) if line.run == "avatarsim/default")
    # one joint in two of four frames
    assert ours.joints == 0.5 and ours.iterations == 0.75 and math.isnan(ours.pairs)


def test_costs_are_the_time_of_a_part_over_its_work(run: Path) -> None:
    one = next(one for one in runs(run) if one.name == "avatarsim/paper")
    us = {"ik": np.array([3.0, 3.0, 0.0]), "collision": np.ones(3), "posing": np.ones(3), "whole": np.full(3, 10.0)}
    found = row(one, Shares(us, ""))
    assert (found.ik_share, found.collision_share, found.posing_share) == pytest.approx((20.0, 10.0, 10.0))
    # over the three frames that were timed: 12 joints, 3 iterations, 4 pairs, 15 queries
    costs = found.us_per_joint, found.us_per_iteration, found.us_per_pair, found.us_per_query
    assert costs == pytest.approx((0.5, 2.0, 0.75, 0.2))


def test_the_command_writes_table_and_trace(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--run", str(run), "--no-clocks"]) == 0
    assert PRINTED in capsys.readouterr().out
    lines = list(csv.DictReader((run / "table_2.csv").read_text().splitlines()))
    assert [line["run"] for line in lines][:2] == [PRINTED, "avatarsim/paper"] and lines[1]["ik_share"] == ""
    trace = list(csv.DictReader((run / "figure_8.csv").read_text().splitlines()))
    assert [line["run"] for line in trace] == ["avatarsim/paper"] * 3 + ["avatarsim/default"] * 3
    assert [(line["frame"], line["us"], line["iterations"]) for line in trace[:3]] == [
        ("1", "10", "1"), ("2", "20", "2"), ("3", "30", "0"),
    ]


def test_the_files_may_go_into_another_run(run: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    assert main(["--run", str(run), "--to", str(other), "--no-clocks"]) == 0
    assert {path.name for path in other.iterdir()} == {"table_2.csv", "figure_8.csv"} and not list(run.glob("*.csv"))


def test_a_run_without_the_scenes_leaves_no_files(tmp_path: Path) -> None:
    (tmp_path / "results.json").write_text('{"series": {}}')
    assert main(["--run", str(tmp_path)]) == 5 and written(tmp_path, tmp_path) == [] and table([]).count("\n") == 0
    assert main(["--run", str(tmp_path / "nowhere")]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]


def test_shares_are_asked_of_our_methods_alone(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def shares_of(one: module.Run) -> Shares:
        asked.append(one.name)
        return Shares({part: np.ones(3) for part in ("ik", "collision", "posing", "whole")}, "")

    monkeypatch.setattr(module, "shares_of", shares_of)
    rows(run)
    assert asked == ["avatarsim/paper", "avatarsim/default"]


@pytest.mark.parametrize("content", ["", "[]", "{}", "[" * 100_000, '{"series": 3}', '{"series": {"two_arms": {"a/b": {}}}}',
                                     '{"series": {"two_arms": {"a/b": {"frame_time_us": [[]], "overlap_m": []}}}}',
                                     '{"series": {}, "rows": [{"metric": "frame_time_p99", "seed": 0, "value": 1}]}'])
def test_results_that_are_damaged_are_refused(tmp_path: Path, content: str, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "results.json").write_text(content)
    assert main(["--run", str(tmp_path)]) == 2
    assert "InvalidFile: results " in capsys.readouterr().err
