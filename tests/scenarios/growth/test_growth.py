"""Scenes of growing size: valid at every size, free at the start, in contact where they say so, and the rows made of them."""

import math
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import UnknownName
from avatarsim.scene.tracker import checked, link_poses
from reference.judging.judge import Judge
from runfiles.csv_rows import csv_text
from scenarios.growth import __main__ as command
from scenarios.growth import worlds
from scenarios.growth.rows import Row, exponent, table
from scenarios.job import Job
from scenarios.measure.timing import Timed
from scenarios.running.timing import Clocked

SIZES = {"links": worlds.LINKS[:3], "avatars": worlds.AVATARS[:2]}
SMALL = [f"{what}_{size}_{mode}" for what, sizes in SIZES.items() for size in sizes for mode in worlds.MODES[what]]


@pytest.mark.parametrize("name", SMALL)
def test_it_starts_free_and_touches_only_where_it_says_so(name: str) -> None:
    scene = worlds.get(name).build()
    motion, judge = worlds.get(name).motion(scene, 0), Judge(scene)
    fixed = [np.array([getattr(body, what) for body in scene.bodies]) for what in ("position", "orientation")]
    deepest = []
    for k in (None, *range(0, worlds.FRAMES, 5)):
        sample = checked(scene.first_sample if k is None else motion(k), scene.avatars)
        positions, turns = link_poses(scene.avatars, sample)
        deepest.append(judge.overlaps(np.vstack([fixed[0], positions]), np.vstack([fixed[1], turns])).deepest)
    assert deepest[0] == 0.0
    assert (max(deepest) > 0.01) if name.endswith("contact") else (max(deepest) == 0.0)
    # in and out again: a part of the frames is free
    assert np.mean(np.array(deepest) > 0.0) < 0.9


@pytest.mark.parametrize("links", worlds.LINKS)
def test_a_comb_has_the_links_that_its_name_says(links: int) -> None:
    assert len(worlds.comb(links).links) == links


def test_unknown_sizes_are_refused() -> None:
    with pytest.raises(UnknownName):
        worlds.get("links_17_apart")


def line(links: int, p50: float, run: str = "avatarsim/default") -> Row:
    return Row("links", "apart", links, links, run, p50, 2.0 * p50, "")


def test_growth_is_the_slope_of_the_logarithms() -> None:
    assert exponent([line(10, 5.0), line(100, 50.0), line(1000, 500.0)]) == pytest.approx(1.0)
    assert exponent([line(10, 5.0), line(100, 500.0), line(1000, math.nan)]) == pytest.approx(2.0)
    assert math.isnan(exponent([line(10, 5.0)]))


def test_the_table_and_the_file_hold_what_is_missing_too() -> None:
    found = [line(10, 5.0), line(100, 50.0), Row("links", "apart", 100, 100, "mujoco/tuned", math.nan, math.nan, "it fell over")]
    text = table(found)
    assert "size^1.00" in text and "not timed: mujoco/tuned, links 100: it fell over" in text
    assert csv_text(found, Row).splitlines()[3] == "links,apart,100,100,mujoco/tuned,,,it fell over"


def test_who_takes_long_is_not_asked_for_a_hundred_avatars() -> None:
    engines = {"avatarsim": ("default", "paper"), "mujoco": ("tuned",)}
    galleries = [job.run for job in command.jobs_of("objects_20_idle", 20, engines)]
    assert galleries == ["avatarsim/default", "avatarsim/paper", "mujoco/tuned", "mujoco/sleeping"]
    crowded = [job.run for job in command.jobs_of("objects_2000_idle", 2000, engines)]
    assert crowded == ["avatarsim/default", "avatarsim/paper", "mujoco/sleeping"]
    assert [job.run for job in command.jobs_of("avatars_100_apart", 100, engines)] == ["avatarsim/default", "avatarsim/paper"]
    assert [job.engine for job in command.jobs_of("links_199_apart", 199, engines)] == ["avatarsim", "avatarsim", "mujoco"]
    assert command.jobs_of("links_199_apart", 199, {"pybullet": ("tuned",)}) == []
    job = command.jobs_of("links_16_contact", 16, engines)[0]
    assert len(job.asked()[1].links) == 16


def test_the_command_times_every_engine_and_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def timed_pass(jobs: list[Job], full: bool) -> list[Clocked]:
        return [Clocked(job, Timed(np.full((2, 5), 4000, dtype=np.int64)), "2 repeats") for job in jobs]

    monkeypatch.setattr(command, "timed_pass", timed_pass)
    assert command.main(["--run", str(tmp_path), "--engine", "avatarsim", "--quick"]) == 0
    lines = (tmp_path / "growth.csv").read_text().splitlines()
    # a head; links, avatars and objects in two modes, contacts in three; two methods
    assert len(lines) == 1 + (3 * 2 + 3) * 2 and lines[1] == "links,apart,16,16,avatarsim/default,4,4,2 repeats"
    monkeypatch.setattr(command, "timed_pass", lambda jobs, full: [Clocked(job, None, "died") for job in jobs])
    assert command.main(["--run", str(tmp_path), "--engine", "avatarsim", "--quick"]) == 3
    assert command.main(["--run", str(tmp_path), "--engine", "abacus"]) == 2
