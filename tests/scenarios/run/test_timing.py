"""The timing pass: fresh loads in persistent processes, shared frames of all engines of a scene, windows of quick timing."""

import math
import multiprocessing
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runfiles.timing_protocol import REPEATS, TAIL_FRAMES, WARM_FRAMES
from scenarios.catalog import get
from scenarios.job import Job
from scenarios.measure.timing import Round, Timed
from scenarios.run.machine import Meter
from scenarios.run.timed_worker import LoadedFrames, TimedWorker, TimedWorkers, window
from scenarios.run.timing import (
    BEFORE_CONTACT,
    CHEAP_TIME,
    LEAD_TIME,
    LEAST_FRAMES,
    LONGEST_REPEAT,
    MOST_FRAMES,
    ROUND_TIME,
    Clocked,
    at_most,
    compared,
    quick_timing,
    rounds,
    timed_pass,
    timing_facts,
)
from tests.scenarios.bad_engines import joined

BALL, ZENO = Job("ball_drop", "avatarsim", "default", frames=12), Job("zeno", "avatarsim", "default", frames=7)
FAST, SLOW, MEDIUM = 1e-6, ROUND_TIME / LEAST_FRAMES, 0.9 * CHEAP_TIME / TAIL_FRAMES
"""Times of a frame [s]: all frames are cheap, the smallest window is not, or only TAIL_FRAMES are."""


def run(worker: TimedWorker, job: Job, frames: int) -> tuple[int, str]:
    worker.prepare(job, frames)
    loaded = worker.answer()
    assert not isinstance(loaded, str) and loaded[0] > 0.0 and loaded[1] is None
    worker.start()
    ran = worker.answer()
    assert not isinstance(ran, str) and ran[0] > 0.0 and ran[1] is not None
    around, stages, last = ran[1]
    assert all(len(spent) == len(around) for spent in stages.values()) and min(around) > 0
    return len(around), last


def test_each_repeat_is_a_fresh_load_whatever_ran_before() -> None:
    worker = TimedWorker()
    found = [run(worker, job, frames) for job, frames in ((BALL, 12), (BALL, 12), (ZENO, 7), (BALL, 5), (BALL, 100))]
    worker.prepare(BALL, 5)
    assert not isinstance(worker.answer(), str)
    worker.close()
    assert worker.child.exitcode == 0
    counts, lasts = zip(*found, strict=True)
    here = [LoadedFrames(job, window(job, frames)).run()[2] for job, frames in ((BALL, 12), (ZENO, 7), (BALL, 5))]
    assert counts == (12, 12, 7, 5, 12) and lasts[0] == lasts[1] == lasts[4] == here[0]
    assert list(lasts[2:4]) == here[1:] and here[2] != here[0]


def test_every_frame_is_timed_or_the_engine_has_a_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(joined(tmp_path))
    before = {child.pid for child in multiprocessing.active_children()}
    jobs = [Job("ball_drop", engine, "default", frames=9) for engine in ("tunnels", "raises", "absent", "dies", "nobody")]
    tunnels, *others = timed_pass(jobs, False)
    timed = tunnels.timed
    assert timed is not None and timed.around_ns.shape == (REPEATS, 9) and (timed.around_ns > 0).all() and timed.warmup > 0.0
    assert np.array_equal(timed.best_us, timed.around_ns.min(axis=0) / 1e3)
    # a scene of nine frames has no further ones to warm up
    assert timed.warm_frames == 9 and len(timed.hashes) == REPEATS and len(set(timed.hashes)) == 1
    assert all(one.timed is None for one in others)
    for one, part in zip(others, ("lost its way", "a_package_that_nobody_has", "signal 9", "nobody"), strict=True):
        assert part in one.note
    assert {child.pid for child in multiprocessing.active_children()} <= before


def test_each_job_has_its_own_number_of_repeats_and_frames() -> None:
    meter, jobs = Meter(), [Job("ball_drop", "tracker", "default", seed=seed) for seed in (0, 1)]
    found = timed_pass(jobs, True, [Round(3, 0, 5), Round(1, 0, 12)], meter=meter)
    assert [one.timed.around_ns.shape for one in found if one.timed] == [(3, 5), (1, 12)] and meter.seconds > 0.0
    facts = timing_facts(meter)
    named = {"warm_frames", "tail_frames", "mhz", "load_after", "busy_elsewhere", "reading_ns"}
    assert facts["repeats"] == REPEATS and named < set(facts)


def test_engines_are_compared_by_what_all_had() -> None:
    shapes = ((3, 200), (1, 46), (2, 90))
    found = [Clocked(Job("zeno", "tracker", "default"), Timed(np.ones(shape, dtype=np.int64))) for shape in shapes]
    none = Clocked(Job("zeno", "tracker", "default"), None, "it died")
    same = compared([*found, none])
    assert [one.timed.shared for one in same if one.timed] == [Round(1, 0, 46)] * 3 and same[-1] is none
    assert compared([none]) == [none]


def test_frames_before_the_window_run_and_are_not_timed() -> None:
    """In a process that stays they are its warm-up."""
    late, early = (Job("hand_over_table", "avatarsim", preset, frames=50) for preset in ("default", "paper"))
    plan = [Round(REPEATS, WARM_FRAMES, 10), Round(REPEATS, WARM_FRAMES - 1, 20)]
    with TimedWorkers() as workers:
        found = compared(timed_pass([late, early], True, plan, [workers.at(job.run) for job in (late, early)]))
    whole = timed_pass([late], True, [Round(1, 0, WARM_FRAMES + 10)])[0].timed
    for one in found:
        assert one.timed is not None and one.timed.shared == plan[0] and one.timed.warm_frames == WARM_FRAMES
        assert one.timed.compared_us.shape == (10,)
    # its final bits equal those of a run timed from its start
    assert whole is not None and found[0].timed is not None and set(found[0].timed.hashes) == set(whole.hashes)


def quick(scene: str, engines: tuple[str, ...], workers: TimedWorkers, frames: int | None = None) -> list[Clocked]:
    jobs = [Job(scene, engine, "default", frames=frames) for engine in engines]
    return quick_timing(jobs, [FAST] * len(jobs), get(scene).as_run(False).frames, workers)


def test_scenes_share_warm_processes_and_frames() -> None:
    with TimedWorkers() as workers:
        first = quick("ball_drop", ("avatarsim", "mujoco"), workers)
        processes = {run: worker.child.pid for run, worker in workers.taken.items()}
        second = quick("zeno", ("avatarsim", "mujoco"), workers)
        assert {run: worker.child.pid for run, worker in workers.taken.items()} == processes and len(processes) == 2
        children = [worker.child for worker in workers.taken.values()]
    assert not any(child.is_alive() for child in children)
    for scene, found in (("ball_drop", first), ("zeno", second)):
        for one in found:
            # both are shorter than the frames required of a longer one
            assert one.timed is not None and one.timed.around_ns.shape == (REPEATS, get(scene).as_run(False).frames)
            assert np.isnan(one.timed.warmup) and one.timed.warm_frames == WARM_FRAMES and len(set(one.timed.hashes)) == 1


def test_an_engine_that_dies_has_a_new_process_in_the_next_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(joined(tmp_path))
    with TimedWorkers() as workers:
        for scene in ("ball_drop", "zeno"):
            dies, raises, lives = compared(quick(scene, ("dies", "raises", "tunnels"), workers, frames=9))
            assert dies.timed is None and "signal 9" in dies.note and raises.timed is None and "lost its way" in raises.note
            # it is compared by the frames of the remaining ones
            assert lives.timed is not None and lives.timed.shared == Round(REPEATS, 0, 9) and lives.timed.warm_frames == 9


def test_a_pass_that_is_stopped_leaves_no_process() -> None:
    with pytest.raises(KeyboardInterrupt), TimedWorkers() as workers:
        quick("ball_drop", ("avatarsim",), workers, frames=9)
        child = workers.taken["avatarsim/default"].child
        raise KeyboardInterrupt
    assert not child.is_alive()


def test_a_scene_of_a_sweep_or_an_everyday_one_is_timed_whole() -> None:
    frames = get("stack_ten").as_run(False).frames
    jobs = [Job("stack_ten", "avatarsim", preset) for preset in ("default", "paper")]
    with TimedWorkers() as workers:
        swept = quick_timing(jobs, [1.0, 1.0], frames, workers, swept=1)
        everyday = quick_timing(jobs[1:], [1.0], frames, workers, at_length=True)
    # the gated engine as often as any, since its slowest frame is that of the scene
    shapes = [one.timed.around_ns.shape for one in (*swept, *everyday) if one.timed]
    assert shapes == [(REPEATS, frames), (1, frames), (REPEATS, frames)]


def test_fast_engine_has_its_tail_beside_a_slow_one() -> None:
    assert rounds([FAST, SLOW, MEDIUM], 600, 0) == [(REPEATS, 0, 600), (1, 0, LEAST_FRAMES), (REPEATS, 0, TAIL_FRAMES)]
    # if the user meets nothing, the frames before the window warm it up
    assert rounds([SLOW, MEDIUM], 600) == [(1, WARM_FRAMES, LEAST_FRAMES), (REPEATS, WARM_FRAMES, TAIL_FRAMES)]
    assert rounds([SLOW], LEAST_FRAMES + 3) == [(1, 3, LEAST_FRAMES)]
    assert rounds([FAST, FAST], 2 * MOST_FRAMES) == [(REPEATS, 0, MOST_FRAMES)] * 2
    assert rounds([0.0, FAST], 600) == [(REPEATS, 0, 600)] * 2
    # the gated engine even if it is slow
    gated, other = rounds([SLOW, SLOW], 600, 300, (True, False))
    assert gated == (REPEATS, 0, 600) and (other.repeats, other.frames) == (1, LEAST_FRAMES)


@given(length=st.integers(10, 1200), share=st.floats(0.0, 1.0), cost=st.floats(1e-5, 0.1))
def test_shared_window_holds_the_first_contact(length: int, share: float, cost: float) -> None:
    whole = min(length, MOST_FRAMES)
    meets = min(int(share * whole), whole - 1)
    plan = rounds([FAST, MEDIUM, cost, 0.5 * cost], length, meets)
    first, last = max(each.first for each in plan), min(each.first + each.frames for each in plan)
    assert first <= meets < last and last - first >= min(length, LEAST_FRAMES)
    assert first == 0 or last == whole or meets - first >= (last - first) // BEFORE_CONTACT
    assert all(0 <= each.first and each.first + each.frames <= whole and each.repeats in (1, REPEATS) for each in plan)


def test_unseen_motion_is_timed_at_its_deepest_contact_in_reach() -> None:
    # a touch at the start, contact in the third second, more in the ninth
    depths = [0.0] * 601
    depths[3], depths[181:201], depths[521:561] = 0.01, 20 * [0.1], 40 * [0.3]
    assert round(LEAD_TIME / SLOW) == 200 and rounds([SLOW], 600, 3, (), depths) == [(1, 160, LEAST_FRAMES)]
    # a sufficiently fast engine reaches the deepest contact, with a longer window; the first contact is always reached
    [fast] = rounds([0.25 * SLOW], 600, 3, (), depths)
    assert fast.first <= 520 and fast.first + fast.frames == 560
    assert rounds([100.0 * SLOW], 600, 190, (), depths) == [(1, 160, LEAST_FRAMES)]
    # with unknown depths the window is that of the first contact
    assert rounds([SLOW], 600, 3) == rounds([SLOW], 600, 3, (), [math.nan] * 601) == [(1, 0, LEAST_FRAMES)]


@pytest.mark.parametrize(("cost", "frames"), [
    (0.0, MOST_FRAMES), (1e-5, MOST_FRAMES), (LONGEST_REPEAT / 200.0, 200), (10.0 * LONGEST_REPEAT, LEAST_FRAMES),
])
def test_a_slow_engine_is_timed_for_so_long_at_most(cost: float, frames: int) -> None:
    assert at_most(cost) == Round(REPEATS, 0, frames)
