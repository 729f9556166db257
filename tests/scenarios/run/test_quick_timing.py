"""A glance: one process per engine for many scenes, the same frames for all to be compared by, and what dies is replaced."""

import math
import os

import numpy as np
import pytest

from runfiles.timing_protocol import REPEATS, TAIL_FRAMES, WARM_FRAMES
from scenarios.catalog import get
from scenarios.job import Job
from scenarios.measure.timing import Shared
from scenarios.run.timed_worker import TimedWorkers
from scenarios.run.timing import (
    BEFORE_CONTACT,
    CHEAP_TIME,
    LEAD_TIME,
    LEAST_FRAMES,
    MOST_FRAMES,
    ROUND_TIME,
    Clocked,
    compared,
    quick_timing,
    rounds,
    timed_pass,
)
from tests.scenarios.bad_engines import joined

BAD = ("dies", "raises", "tunnels")
FAST = 1e-6
"""Time of a frame [s] of which as many as there are take nearly nothing."""


def looked(scene: str, engines: tuple[str, ...], workers: TimedWorkers, frames: int | None = None) -> list[Clocked]:
    jobs = [Job(scene, engine, "default", frames=frames) for engine in engines]
    return quick_timing(jobs, [FAST] * len(jobs), get(scene).as_run(False).frames, workers)


def test_scenes_share_processes_and_every_engine_is_warm_and_has_the_same_frames() -> None:
    with TimedWorkers() as workers:
        first = looked("ball_drop", ("avatarsim", "mujoco"), workers)
        processes = {run: worker.child.pid for run, worker in workers.taken.items()}
        second = looked("zeno", ("avatarsim", "mujoco"), workers)
        assert {run: worker.child.pid for run, worker in workers.taken.items()} == processes and len(processes) == 2
        children = [worker.child for worker in workers.taken.values()]
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
    with TimedWorkers() as workers:
        for scene in ("ball_drop", "zeno"):
            dies, raises, lives = compared(looked(scene, BAD, workers, frames=9))
            assert dies.timed is None and "killed by signal 9" in dies.note
            assert raises.timed is None and "the solver has lost its way" in raises.note
            # it is compared by what those had that are left
            assert lives.timed is not None and lives.timed.shared == Shared(REPEATS, 0, 9) and lives.timed.warm_frames == 9


def test_somebody_who_stops_it_waits_for_nobody() -> None:
    with pytest.raises(KeyboardInterrupt), TimedWorkers() as workers:
        looked("ball_drop", ("avatarsim",), workers, frames=9)
        child = workers.taken["avatarsim/default"].child
        raise KeyboardInterrupt
    assert not child.is_alive()


def test_what_is_fast_has_the_whole_scene_or_enough_for_a_tail_whatever_is_slow_beside_it() -> None:
    slow, medium = ROUND_TIME / LEAST_FRAMES, 0.9 * CHEAP_TIME / TAIL_FRAMES
    assert slow * LEAST_FRAMES > CHEAP_TIME
    assert rounds([FAST, slow, medium], 600) == [(REPEATS, 0, 600), (1, 0, LEAST_FRAMES), (REPEATS, 0, TAIL_FRAMES)]
    assert rounds([FAST, FAST], 2 * MOST_FRAMES) == [(REPEATS, 0, MOST_FRAMES)] * 2
    assert rounds([0.0, FAST], 600) == [(REPEATS, 0, 600)] * 2


def test_the_engine_of_the_gate_is_timed_over_the_whole_scene_however_slow_it_is() -> None:
    slow = ROUND_TIME / LEAST_FRAMES
    ours, theirs = rounds([slow, slow], 600, 300, (True, False))
    assert ours == (REPEATS, 0, 600) and (theirs.repeats, theirs.frames) == (1, LEAST_FRAMES)
    assert rounds([slow], 2 * MOST_FRAMES, 0, (True,)) == [(REPEATS, 0, MOST_FRAMES)]


@pytest.mark.parametrize("meets", [0, 20, 300, 599])
def test_the_window_that_all_have_holds_the_first_contact(meets: int) -> None:
    slow, medium = ROUND_TIME / LEAST_FRAMES, 0.9 * CHEAP_TIME / TAIL_FRAMES
    fast, tail, window = rounds([FAST, medium, slow], 600, meets)
    assert window.first <= meets < window.first + window.frames <= 600
    # what is timed for longer has all of the window, and frames before contact unless it comes at once
    for longer in (fast, tail):
        assert longer.first <= window.first and window.first + window.frames <= longer.first + longer.frames
    assert window.first == 0 or meets - window.first >= window.frames // BEFORE_CONTACT


def test_a_motion_drawn_anew_is_timed_where_its_user_is_deepest_as_far_as_the_lead_reaches() -> None:
    # a touch at once, contact in the third second, more in the ninth
    depths = [0.0] * 601
    depths[3], depths[181:201], depths[521:561] = 0.01, 20 * [0.1], 40 * [0.3]
    slow = ROUND_TIME / LEAST_FRAMES
    assert round(LEAD_TIME / slow) == 200 and rounds([slow], 600, 3, (), depths) == [(1, 160, LEAST_FRAMES)]
    # an engine that is fast enough reaches the deepest, with a longer window; the first contact is reached whatever it takes
    fast = rounds([0.25 * slow], 600, 3, (), depths)[0]
    assert fast.first <= 520 and fast.first + fast.frames == 560
    assert rounds([100.0 * slow], 600, 190, (), depths) == [(1, 160, LEAST_FRAMES)]
    # where it is not known how deep it is the window is that of the first contact
    assert rounds([slow], 600, 3) == rounds([slow], 600, 3, (), [math.nan] * 601) == [(1, 0, LEAST_FRAMES)]


def test_frames_before_the_window_run_and_are_not_timed() -> None:
    late, early = (Job("hand_over_table", "avatarsim", preset, frames=40) for preset in ("default", "paper"))
    found = compared(timed_pass([late, early], True, frames=[10, 25], firsts=[30, 15]))
    whole = timed_pass([late], True, frames=[40])[0].timed
    for clocked in found:
        assert clocked.timed is not None and clocked.timed.shared == Shared(REPEATS, 30, 10)
        assert clocked.timed.compared_us.shape == (10,)
    assert found[0].timed is not None and "10 frames from frame 30" in found[0].note
    # it ends in the bits of a run that was timed from its start
    assert whole is not None and set(found[0].timed.hashes) == set(whole.hashes)


@pytest.mark.parametrize("length", [10, LEAST_FRAMES, 75, 600])
@pytest.mark.parametrize("slow", [1e-5, ROUND_TIME / 100, ROUND_TIME / 50, 0.1])
def test_all_have_the_first_frames_and_none_more_than_there_are(length: int, slow: float) -> None:
    plan = rounds([FAST, slow, slow / 2.0], length)
    frames = [each.frames for each in plan]
    assert min(frames) >= min(length, LEAST_FRAMES) and max(frames) == length
    assert all(each.repeats in (1, REPEATS) and each.first == 0 for each in plan) and plan[0].repeats == REPEATS


def test_an_everyday_scene_is_timed_at_its_length_as_often_as_any() -> None:
    frames = get("ball_drop").as_run(False).frames
    with TimedWorkers() as workers:
        [clocked] = quick_timing([Job("ball_drop", "avatarsim", "default")], [1.0], frames, workers, at_length=True)
    assert clocked.timed is not None and clocked.timed.around_ns.shape == (REPEATS, frames)


def test_a_scene_that_a_sweep_times_is_timed_as_often_and_over_the_same_frames() -> None:
    frames = get("stack_ten").as_run(False).frames
    jobs = [Job("stack_ten", "avatarsim", preset) for preset in ("default", "paper")]
    with TimedWorkers() as workers:
        found = quick_timing(jobs, [1.0, 1.0], frames, workers, swept=1)
    # the gated one all the same as often as any, since its slowest frame is that of the scene
    assert [each.timed.around_ns.shape for each in found if each.timed] == [(REPEATS, frames), (1, frames)]
