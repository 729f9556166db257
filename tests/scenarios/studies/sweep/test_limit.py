"""Distances between runs, the order in which they fall, and which runs are asked again."""

import math
from pathlib import Path

import numpy as np
import pytest

from scenarios import catalog
from scenarios.job import Job
from scenarios.results.store import Entry, Store
from scenarios.studies.sweep import limit, limits_run
from scenarios.studies.sweep.limit import FINEST, RATES, Row, distance, job_of, moving, order, rows


def test_distances_against_the_plain_definition() -> None:
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(7, 4, 3)), rng.normal(size=(9, 4, 3))
    each = [math.dist(a[f, n], b[f, n]) for f in range(7) for n in (1, 3)]
    root, most = distance(a, b, (1, 3))
    assert root == pytest.approx(math.sqrt(sum(d * d for d in each) / len(each))) and most == pytest.approx(max(each))
    assert math.isnan(distance(np.full((2, 1, 3), math.nan), np.zeros((2, 1, 3)), (0,))[0])


def line(rate: int, off: float) -> Row:
    return Row("s", "e", "p", rate, off, off, 0.0, 0.0, 0.0, "")


def test_the_order_is_the_slope() -> None:
    assert order([line(rate, 3.0 / rate**2) for rate in RATES] + [line(FINEST, 0.0)]) == pytest.approx(2.0)
    assert math.isnan(order([line(60, 1.0)]))


def test_what_moves_is_compared() -> None:
    scene = catalog.get("driven_10cm_wall").build()
    assert [scene.names[k] for k in moving(scene)] == ["hand"]


def test_each_engine_takes_its_own_kind_of_steps() -> None:
    theirs, ours = job_of("hand_grasp", "mujoco", "tuned", 240), job_of("hand_grasp", "avatarsim", "paper", 240, frames=3)
    assert theirs.options == {"dt": 1 / 240} and theirs.scenario == "hand_grasp" and theirs.base == "tuned"
    assert ours.scenario == "hand_grasp~4" and ours.frames == 12 and ours.options == {} and ours.base == "paper"


def test_a_run_shows_its_rendered_frames_alone(tmp_path: Path) -> None:
    found = {}
    for engine in ("avatarsim", "mujoco"):
        at = tmp_path / f"{engine}.npy"
        entry = limit.ran(job_of("driven_10cm_wall", engine, "default", 120, frames=5), at)
        assert entry["note"] == "" and entry["overlap"] >= 0.0 and entry["beyond"] == 0.0
        found[engine] = np.load(at)
    scene = catalog.get("driven_10cm_wall").build()
    assert all(poses.shape == (6, len(scene.names), 3) for poses in found.values())
    np.testing.assert_allclose(found["avatarsim"][0], found["mujoco"][0], atol=1e-12)


def test_rows_are_distances_from_the_own_finest_run_and_from_ours() -> None:
    scene = catalog.get("driven_10cm_wall").build()
    still = np.zeros((3, len(scene.names), 3))
    entry: Entry = {"note": "", "overlap": 1e-3, "beyond": 0.0}
    dead: Entry = {"note": "it died", "overlap": None, "beyond": None}
    known = {
        ("mujoco", "tuned", 60): (entry, still + (0.3, 0.0, 0.0)), ("mujoco", "tuned", FINEST): (entry, still + (0.1, 0.0, 0.0)),
        ("avatarsim", "default", FINEST): (entry, still), ("pybullet", "tuned", 60): (entry, still),
        ("pybullet", "tuned", FINEST): (dead, None),
    }
    found = {(row.engine, row.rate): row for row in rows("driven_10cm_wall", scene, known)}
    coarse = found["mujoco", 60]
    assert coarse.off == pytest.approx(0.2) and coarse.off_max == pytest.approx(0.2) and coarse.from_ours == pytest.approx(0.3)
    assert found["mujoco", FINEST].off == 0.0 and found["mujoco", FINEST].from_ours == pytest.approx(0.1)
    assert math.isnan(found["pybullet", 60].off) and found["pybullet", 60].note == "its finest run is missing"
    assert math.isnan(found["pybullet", FINEST].overlap) and found["pybullet", FINEST].note == "it died"


def test_known_runs_are_not_asked_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def ran(job: Job, to: Path) -> Entry:
        if len(asked) == 3:
            raise KeyboardInterrupt
        asked.append(job.stem)
        np.save(to, np.full((2, 2, 3), float(len(asked))))
        return {"run": job.run, "note": "", "overlap": 0.0, "beyond": 0.0}

    monkeypatch.setattr(limit, "ran", ran)
    words = (["driven_10cm_wall"], {"mujoco": ("tuned",)}, Store(tmp_path), 0, False, 2)
    with pytest.raises(KeyboardInterrupt):
        limits_run.converge(*words)
    first, asked[:] = list(asked), []
    found = limits_run.converge(*words)
    assert str(FINEST) in first[0]
    assert len(first) == 3 and not set(first) & set(asked) and len(first + asked) == len(RATES) + 1
    asked[:] = []
    assert limits_run.converge(*words) == found and asked == []
    for content in (b"", b"\x93NUMPY"):
        next(tmp_path.glob("*.npy")).write_bytes(content)
        limits_run.converge(*words)
        assert len(asked) == 1 and asked.pop()
    text = limits_run.table(found)
    assert "driven_10cm_wall" in text and "mujoco/tuned" in text


def test_an_engine_that_raises_or_dies_has_that_for_its_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entry = limit.ran(job_of("driven_10cm_wall", "mujoco", "nobody", 60, frames=2), tmp_path / "x.npy")
    assert "nobody" in entry["note"] and entry["overlap"] is None and not (tmp_path / "x.npy").exists()
    from avatarsim.running.processes import Died

    monkeypatch.setattr(limits_run, "side_by_side", lambda function, todo, workers: [(job, Died("killed")) for job in todo])
    found = limits_run.converge(["driven_10cm_wall"], {"mujoco": ("tuned",)}, Store(tmp_path), 2, False, 2)
    assert {row.note for row in found} == {"killed"} and all(math.isnan(row.off) for row in found)
