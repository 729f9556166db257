"""A glance: one process per engine for many scenes, the same frames for all to be compared by, and what dies is replaced."""

import os

import numpy as np
import pytest

from scenarios import glance as module
from scenarios.catalog import get
from scenarios.glance import CHEAP, LEAST, SLICE, rounds
from scenarios.job import Job
from scenarios.measure.protocol import REPEATS, TAIL_FRAMES, WARM_FRAMES
from scenarios.seats import Seats
from scenarios.timing import Clocked, compared
from tests.scenarios.bad_engines import joined

BAD = ("dies", "raises", "tunnels")
FAST = 1e-6
"""Time of a frame [s] of which as many as there are take nearly nothing."""


def looked(scene: str, engines: tuple[str, ...], seats: Seats, cost: float = FAST, frames: int | None = None) -> list[Clocked]:
    jobs = [Job(scene, engine, "default", frames=frames) for engine in engines]
    return module.glance(jobs, [cost] * len(jobs), get(scene).as_run(False).frames, seats)


def test_scenes_share_processes_and_every_engine_is_warm_and_has_the_same_frames() -> None:
    with Seats() as seats:
        first = looked("ball_drop", ("avatarsim", "mujoco"), seats)
        processes = {run: seat.child.pid for run, seat in seats.taken.items()}
        second = looked("zeno", ("avatarsim", "mujoco"), seats)
        assert {run: seat.child.pid for run, seat in seats.taken.items()} == processes and len(processes) == 2
        children = [seat.child for seat in seats.taken.values()]
    assert not any(child.is_alive() for child in children)
    for scene, found in (("ball_drop", first), ("zeno", second)):
        assert len(found) == 2
        for clocked in found:
            # both are shorter than what is wanted of a longer one
            assert clocked.timed is not None and clocked.timed.around_ns.shape == (REPEATS, get(scene).as_run(False).frames)
            assert np.isnan(clocked.timed.warmup) and clocked.timed.warm_frames == WARM_FRAMES
            assert len(set(clocked.timed.hashes)) == 1 and clocked.note == clocked.timed.protocol.said


def test_who_dies_says_so_and_the_next_scene_gets_a_new_process(
    tmp_path: os.PathLike[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(joined(tmp_path))
    with Seats() as seats:
        for scene in ("ball_drop", "zeno"):
            dies, raises, lives = compared(looked(scene, BAD, seats, frames=9))
            assert dies.timed is None and "killed by signal 9" in dies.note
            assert raises.timed is None and "the solver has lost its way" in raises.note
            # it is compared by what those had that are left
            assert lives.timed is not None and lives.timed.shared == (REPEATS, 9) and lives.timed.warm_frames == 9


def test_somebody_who_stops_it_waits_for_nobody() -> None:
    with pytest.raises(KeyboardInterrupt), Seats() as seats:
        looked("ball_drop", ("avatarsim",), seats, frames=9)
        child = seats.taken["avatarsim/default"].child
        raise KeyboardInterrupt
    assert not child.is_alive()


def test_what_is_fast_has_enough_for_a_tail_whatever_is_slow_beside_it() -> None:
    slow = SLICE / LEAST
    assert slow * LEAST > CHEAP
    assert rounds([FAST, slow, slow], 600) == [(REPEATS, TAIL_FRAMES), (1, LEAST), (1, LEAST)]
    assert rounds([FAST, FAST], 600) == [(REPEATS, TAIL_FRAMES)] * 2
    assert rounds([0.0, FAST], 600) == [(REPEATS, TAIL_FRAMES)] * 2


@pytest.mark.parametrize("length", [10, LEAST, 75, 600])
@pytest.mark.parametrize("slow", [1e-5, SLICE / 100, SLICE / 50, 0.1])
def test_all_have_the_first_frames_and_none_more_than_there_are(length: int, slow: float) -> None:
    plan = rounds([FAST, slow, slow / 2.0], length)
    frames = [count for _, count in plan]
    assert min(frames) >= min(length, LEAST) and max(frames) == min(length, TAIL_FRAMES)
    assert all(repeats in (1, REPEATS) for repeats, _ in plan) and plan[0][0] == REPEATS


def test_an_everyday_scene_is_timed_at_its_length_as_often_as_any() -> None:
    frames = get("ball_drop").as_run(False).frames
    with Seats() as seats:
        [clocked] = module.glance([Job("ball_drop", "avatarsim", "default")], [1.0], frames, seats, at_length=True)
    assert clocked.timed is not None and clocked.timed.around_ns.shape == (REPEATS, frames)
