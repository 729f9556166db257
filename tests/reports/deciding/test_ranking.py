"""The matrix has a cell for every scene, measure and engine, says which is best, and never lets the raw tracker win."""

from collections.abc import Callable
from pathlib import Path

from reports.deciding.ranking import ranks, runs_of, sentence, tolerances
from reports.deciding.tables import blocks
from reports.reading.load import load
from runfiles.behind import compared

Json = dict[str, object]
Write = Callable[[object], Path]


def test_cells_stand_under_their_engines(run_dir: Write, results: Json) -> None:
    shown = blocks(load(run_dir(results)))
    runs, found = runs_of(shown), ranks(shown)
    assert runs == ("avatarsim/default", "mujoco/default", "mujoco/tuned", "pybullet/default")
    wall = next(rank for rank in found if rank.scene == "arm_wall")
    assert [row.name for row in wall.rows] == ["overlap", "p95"]
    assert [cell.value for cell in wall.rows[0].cells if cell] == [3e-7, 4e-3, 6e-5, 1e-5]
    assert [bool(cell and cell.best) for cell in wall.rows[0].cells] == [True, False, False, False]


def test_the_error_names_its_metric(run_dir: Write, results: Json) -> None:
    drop = next(rank for rank in ranks(blocks(load(run_dir(results)))) if rank.scene == "ball_drop")
    error = next(row for row in drop.rows if row.name == "error")
    assert error.metric == "restitution_error_max"
    assert "crashed" in drop.trouble


def test_losses_are_named(run_dir: Write, results: Json) -> None:
    found = load(run_dir(results))
    shown, counted = blocks(found), compared(found.rows, "avatarsim/default")
    said = sentence(ranks(shown), "avatarsim/default", runs_of(shown), counted)
    # hand_over_table: ours leaves 2.7 um, theirs at best 90 um; ball_drop: 0.3 against 0.02
    assert said == ("avatarsim/default is best or level: overlap in 2 of 2 families; error in 0 of 1 family, behind in ball_drop "
                    "(×15); p95 in 2 of 2 families without an avatar.")
    walls = {"arm_wall": "walls", "hand_over_table": "walls"}
    assert "p95 in 1 of 1 family without an avatar." in sentence(
        ranks(shown), "avatarsim/default", runs_of(shown), counted, walls)
    assert "1 µm" in tolerances() and "frame time, 95th percentile: 10%" in tolerances()


def test_alone_nobody_is_ranked(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    found = load(run_dir(results | {"rows": [row for row in rows if row["engine"] == "avatarsim"]}))
    shown, counted = blocks(found), compared(found.rows, "avatarsim/default")
    assert "nothing to be ranked against" in sentence(ranks(shown), "avatarsim/default", runs_of(shown), counted)
