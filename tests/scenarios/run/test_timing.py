"""The timing pass with engines that work, that raise, and that are not there. No figure is judged: machines differ."""

import multiprocessing

import numpy as np
import pytest

from runfiles.timing_protocol import REPEATS
from scenarios.job import Job
from scenarios.measure.timing import Shared, Timed
from scenarios.run.machine import Meter
from scenarios.run.timing import Clocked, compared, timed_pass, timing_facts
from tests.scenarios.bad_engines import joined


@pytest.fixture(scope="module")
def clocked(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Clocked]:
    folder = joined(tmp_path_factory.mktemp("site"))
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(folder)
    jobs = [Job("ball_drop", engine, "default", frames=9) for engine in ("tunnels", "raises", "absent", "dies")]
    found = {clocked.job.engine: clocked for clocked in timed_pass(jobs, False)}
    patch.undo()
    return found


def test_every_frame_of_every_repeat_is_timed(clocked: dict[str, Clocked]) -> None:
    timed = clocked["tunnels"].timed
    assert timed is not None and timed.around_ns.shape == (REPEATS, 9)
    assert (timed.around_ns > 0).all() and timed.best_us.shape == (9,) and timed.warmup > 0.0
    assert np.array_equal(timed.best_us, timed.around_ns.min(axis=0) / 1e3)
    assert len(timed.hashes) == REPEATS and len(set(timed.hashes)) == 1
    # a scene of nine frames has no more to warm up with
    assert clocked["tunnels"].note == f"{REPEATS} x 9 frames, 9 warm-up frames"


@pytest.mark.parametrize(("engine", "said"), [
    ("raises", "the solver has lost its way"), ("absent", "a_package_that_nobody_has"), ("dies", "killed by signal 9"),
])
def test_who_gives_no_times_says_why(clocked: dict[str, Clocked], engine: str, said: str) -> None:
    assert clocked[engine].timed is None and said in clocked[engine].note


@pytest.mark.parametrize("engine", ["tracker", "a_name_that_nobody_has"])
def test_no_child_is_left_behind(engine: str) -> None:
    # tests before this one in the same process may have children of their own that are about to end
    before = {child.pid for child in multiprocessing.active_children()}
    [found] = timed_pass([Job("ball_drop", engine, "default", frames=3)], False)
    assert (found.timed is None) == (engine != "tracker")
    assert {child.pid for child in multiprocessing.active_children()} <= before


def test_each_job_is_run_as_often_and_as_long_as_it_is_told_to() -> None:
    meter, jobs = Meter(), [Job("ball_drop", "tracker", "default", seed=seed) for seed in (0, 1)]
    often, seldom = timed_pass(jobs, True, frames=[5, 12], repeats=[3, 1], meter=meter)
    assert often.timed is not None and often.timed.around_ns.shape == (3, 5)
    assert seldom.timed is not None and seldom.timed.around_ns.shape == (1, 12)
    assert meter.seconds > 0.0
    facts = timing_facts(meter)
    said = {"warm_frames", "tail_frames", "mhz", "load_after", "busy_elsewhere", "reading_ns"}
    assert facts["repeats"] == REPEATS and said < set(facts)


def test_engines_are_compared_by_the_repeats_and_frames_that_all_had() -> None:
    shapes = ((3, 200), (1, 46), (2, 90))
    found = [Clocked(Job("zeno", "tracker", "default"), Timed(np.ones(shape, dtype=np.int64))) for shape in shapes]
    none = Clocked(Job("zeno", "tracker", "default"), None, "it died")
    told = compared([*found, none])
    assert [clocked.timed.shared for clocked in told if clocked.timed] == [Shared(1, 0, 46)] * 3 and told[-1] is none
    assert compared([none]) == [none]
