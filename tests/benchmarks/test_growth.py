"""Scenes of growing size: valid, free at the start, in contact where their names have it; every engine is timed and written."""

import csv
from pathlib import Path

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import UnknownName
from avatarsim.scene.tracker import checked, link_poses
from avatarsim.simulator import AvatarsimEngine
from benchmarks import growth
from benchmarks import growth_scenes as scenes
from benchmarks.__main__ import main
from reference.judging.judge import Judge
from scenarios.job import Job
from scenarios.measure.timing import Timed
from scenarios.run.accuracy import prepare
from scenarios.run.timing import Clocked

SMALL = [f"{kind}_{size}_{mode}" for kind in ("links", "avatars") for size in scenes.SIZES[kind][:2]
         for mode in scenes.MODES[kind]]


@pytest.mark.parametrize("name", SMALL)
def test_it_starts_free_and_touches_only_in_mode_contact(name: str) -> None:
    scene = scenes.get(name).build()
    motion, judge = scenes.get(name).motion(scene, 0), Judge(scene)
    fixed = [np.array([getattr(body, what) for body in scene.bodies]) for what in ("position", "orientation")]
    deepest = []
    for k in (None, *range(0, 90, 5)):
        sample = checked(scene.first_sample if k is None else motion(k), scene.avatars)
        positions, turns = link_poses(scene.avatars, sample)
        deepest.append(judge.overlaps(np.vstack([fixed[0], positions]), np.vstack([fixed[1], turns])).deepest)
    assert deepest[0] == 0.0 and ((max(deepest) > 0.01) if name.endswith("contact") else (max(deepest) == 0.0))
    # in and out again: a part of the frames is free
    assert np.mean(np.array(deepest) > 0.0) < 0.9


@pytest.mark.parametrize(("mode", "moved"), [("idle", 0), ("pushed", 1)])
def test_the_hand_moves_one_object_or_none(mode: str, moved: int) -> None:
    scenario = scenes.get(f"objects_20_{mode}")
    scene = scenario.build()
    motion, engine, judge = scenario.motion(scene, 0), AvatarsimEngine(), Judge(scene)
    first = engine.load(scene, Settings(), scenario.dt)
    found = [engine.advance(motion(k), scenario.dt) for k in range(scenario.frames)]
    assert not any(record.statuses for record in found)
    assert max(judge.overlaps(r.shown.positions, r.shown.orientations).deepest for r in (first, *found[::10])) <= 1e-6
    ways = np.linalg.norm(found[-1].shown.positions - first.shown.positions, axis=1)
    assert ways[-1] == pytest.approx(moved * scenes.WAY, abs=0.02)
    assert np.sum(ways[:-1] > 0.05) == moved and np.sum(ways[:-1] > 1e-6) == moved


def test_sizes_and_engines_that_are_not_known_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UnknownName):
        scenes.get("links_17_apart")
    assert main(["growth", "--run", str(tmp_path), "--engine", "abacus"]) == 2


def test_an_engine_that_takes_long_gets_no_large_scene() -> None:
    engines = {"avatarsim": ("default", "paper"), "mujoco": ("tuned",)}

    def runs(kind: str, size: int, mode: str) -> list[str]:
        return [job.run for job in growth.jobs_of(kind, size, mode, engines)]

    both = ["avatarsim/default", "avatarsim/paper"]
    assert runs("objects", 20, "idle") == [*both, "mujoco/tuned", "mujoco/sleeping"]
    assert runs("objects", 2000, "idle") == [*both, "mujoco/sleeping"]
    assert runs("avatars", 100, "apart") == both and runs("links", 199, "apart") == [*both, "mujoco/tuned"]
    assert growth.jobs_of("links", 199, "apart", {"pybullet": ("tuned",)}) == []
    for links in scenes.SIZES["links"]:
        assert len(prepare(growth.jobs_of("links", links, "contact", engines)[0]).scene.links) == links


def test_the_power_is_that_of_the_size() -> None:
    smaller = growth.Row("links", "apart", 16, 16, "avatarsim/default", 2.0, 2.0)
    job = Job("links_61_apart", "avatarsim", "default", catalogue=scenes.__name__)
    clocked = Clocked(job, Timed(np.full((2, 5), 8000, dtype=np.int64)))
    found = growth.row("links", "apart", 64, clocked, smaller)
    assert (found.p50, found.p95, found.links) == (8.0, 8.0, 61) and found.power == pytest.approx(1.0)


def test_the_command_times_every_engine_and_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def timed_pass(jobs: list[Job], full: bool) -> list[Clocked]:
        return [Clocked(job, Timed(np.full((2, 5), 4000, dtype=np.int64)), "2 repeats") for job in jobs]

    monkeypatch.setattr(growth, "timed_pass", timed_pass)
    assert main(["growth", "--run", str(tmp_path), "--engine", "avatarsim", "--quick"]) == 0
    rows = list(csv.DictReader((tmp_path / "growth.csv").read_text().splitlines()))
    # links, avatars and objects in two modes and two methods
    assert len(rows) == 12 and (rows[0]["size"], rows[0]["p50"], rows[0]["power"]) == ("16", "4", "")
    monkeypatch.setattr(growth, "timed_pass", lambda jobs, full: [Clocked(job, None, "died") for job in jobs])
    assert main(["growth", "--run", str(tmp_path), "--engine", "avatarsim", "--quick"]) == 3
    assert "died" in (tmp_path / "growth.csv").read_text()
