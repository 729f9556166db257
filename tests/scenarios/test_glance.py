"""A glance: one process per engine for many scenes, the same frames for all, and what dies is replaced."""

import os

import numpy as np
import pytest

from scenarios import glance as module
from scenarios.catalog import get
from scenarios.glance import LEAST, MOST, ONCE, ROUNDS, SLICE
from scenarios.job import Job
from scenarios.seats import Seats
from tests.scenarios.bad_engines import joined

BAD = ("dies", "raises", "tunnels")


def test_scenes_share_processes_and_every_engine_has_the_same_frames() -> None:
    with Seats() as seats:
        first = module.glance([Job("ball_drop", engine, "default") for engine in ("avatarsim", "mujoco")], 1e-3, seats)
        processes = {run: seat.child.pid for run, seat in seats.taken.items()}
        second = module.glance([Job("zeno", engine, "default") for engine in ("avatarsim", "mujoco")], 1e-3, seats)
        assert {run: seat.child.pid for run, seat in seats.taken.items()} == processes and len(processes) == 2
        children = [seat.child for seat in seats.taken.values()]
    assert not any(child.is_alive() for child in children)
    for found in (first, second):
        shapes = {clocked.timed.around_ns.shape for clocked in found if clocked.timed is not None}
        assert len(found) == 2 and len(shapes) == 1
        rounds, frames = shapes.pop()
        assert rounds == 1 and LEAST <= frames <= MOST
        for clocked in found:
            assert clocked.timed is not None and np.isnan(clocked.timed.warmup) and len(set(clocked.timed.hashes)) == 1


def test_who_dies_says_so_and_the_next_scene_gets_a_new_process(
    tmp_path: os.PathLike[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(joined(tmp_path))
    with Seats() as seats:
        for scene in ("ball_drop", "zeno"):
            dies, raises, lives = module.glance([Job(scene, engine, "default", frames=9) for engine in BAD], 1e-3, seats)
            assert dies.timed is None and "killed by signal 9" in dies.note
            assert raises.timed is None and "the solver has lost its way" in raises.note
            assert lives.timed is not None


def test_somebody_who_stops_it_waits_for_nobody() -> None:
    with pytest.raises(KeyboardInterrupt), Seats() as seats:
        module.glance([Job("ball_drop", "avatarsim", "default", frames=9)], 1e-3, seats)
        child = seats.taken["avatarsim/default"].child
        raise KeyboardInterrupt
    assert not child.is_alive()


@pytest.mark.parametrize(("cost", "frames"), [(1.0, LEAST), (SLICE / 50, 50), (1e-9, MOST), (0.0, MOST)])
def test_slow_engines_are_timed_over_fewer_frames(cost: float, frames: int) -> None:
    with Seats() as seats:
        [clocked] = module.glance([Job("ball_drop", "avatarsim", "default")], cost, seats)
    assert clocked.timed is not None and clocked.timed.around_ns.shape == (1, frames)


@pytest.mark.parametrize("scene", ["ball_drop", "arm_in_corner"])
def test_everyday_scenes_are_timed_at_their_length_and_long_ones_once(scene: str) -> None:
    with Seats() as seats:
        [clocked] = module.glance([Job(scene, "avatarsim", "default")], 1e-3, seats, at_length=True)
    frames = get(scene).as_run(False).frames
    assert clocked.timed is not None and clocked.timed.around_ns.shape == (1 if frames >= ONCE else ROUNDS, frames)
    assert (frames >= ONCE) == (scene == "arm_in_corner")
    assert clocked.note == f"{'1 repeat' if frames >= ONCE else '2 repeats'} of {frames} frames"
