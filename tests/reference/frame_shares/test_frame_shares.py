"""Twins show the same frames as the frames they stand for, and their clocks add up."""

import platform

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput
from avatarsim.jit.kernel import OPTIONS, njit
from avatarsim.paper import method as paper
from avatarsim.simulator import AvatarsimEngine
from reference.frame_shares import cycles
from reference.frame_shares.cycles import clocked, per_microsecond, spent, twin
from reference.frame_shares.measure import measured
from reference.frame_shares.twins import TWINS
from scenarios import catalog


@njit(**OPTIONS)
def much(count):
    total = 0.0
    for k in range(count):
        total += np.sqrt(k + total)
    return total


@njit(**OPTIONS)
def both(count):
    return much(count) + 1.0


@njit(**OPTIONS)
def one_more(count):
    return much(count) + 2.0


def test_a_clock_changes_no_answer_and_counts_what_is_done():
    timed = clocked(much, 3)
    timed(10)
    found = []
    for count in (100_000, 1_000_000):
        spent[:] = 0
        assert timed(count) == much(count)
        found.append(int(spent[3]))
        assert spent[[0, 1, 2, 4, 5]].sum() == 0
    # no ratio of the two: whatever else runs on the machine may take its time in the middle of either
    assert min(found) > 10_000
    assert 100.0 < per_microsecond() < 10_000.0


def test_a_twin_calls_what_it_is_given():
    assert twin(both, {"much": one_more})(50) == both(50) + 2.0
    with pytest.raises(KeyError, match="nothing"):
        twin(both, {"nothing": one_more})


@pytest.mark.parametrize("method", TWINS)
def test_the_frames_with_clocks_are_the_frames_without_and_the_parts_are_in_the_whole(method):
    scenario = catalog.get("two_arms").as_run(False)
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    samples = [motion(k) for k in range(90)]
    engine = AvatarsimEngine()
    shown = engine.load(scene, Settings(method), scenario.dt)
    for sample in samples:
        shown = engine.advance(sample, scenario.dt)
    original = paper.follow_printed
    found = measured(scene, samples, scenario.dt, method, repeats=1)
    assert paper.follow_printed is original
    assert found.state_hash == shown.state_hash()
    parts = np.sum([us for name, us in found.us.items() if name != "whole"], axis=0)
    assert (parts > 0.0).all() and (parts <= found.us["whole"]).all()
    assert all(found.share(name) > 0.0 for name in ("collision", "ik", "posing"))


def test_other_processors_are_refused(monkeypatch):
    monkeypatch.setattr(platform, "machine", lambda: "abacus")
    with pytest.raises(InvalidInput, match="abacus"):
        cycles.require_counter()
