"""The gallery: no two objects touch at the start, an idle hand touches nothing, a pushing one moves one object and no other."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from reference.judging.judge import Judge
from scenarios.growth import worlds
from scenarios.growth.gallery import WAY


def last(count: int, mode: str) -> tuple[np.ndarray, np.ndarray, float]:
    """Positions at the start and at the end, and the deepest overlap shown."""
    scenario = worlds.get(f"objects_{count}_{mode}")
    scene = scenario.build()
    motion, engine, judge = scenario.motion(scene, 0), AvatarsimEngine(), Judge(scene)
    first = engine.load(scene, Settings(), scenario.dt)
    found = [engine.advance(motion(k), scenario.dt) for k in range(scenario.frames)]
    shown = [first, *found[::10], found[-1]]
    deepest = max(judge.overlaps(r.shown.positions, r.shown.orientations).deepest for r in shown)
    assert not any(record.statuses for record in found)
    return first.shown.positions, found[-1].shown.positions, deepest


def test_an_idle_hand_leaves_everything_where_it_is() -> None:
    before, after, deepest = last(20, "idle")
    np.testing.assert_allclose(after, before, atol=1e-6)
    assert deepest <= 1e-6


def test_a_pushing_hand_moves_one_object_and_no_other() -> None:
    before, after, deepest = last(20, "pushed")
    moved = np.linalg.norm(after - before, axis=1)
    assert moved[-1] == pytest.approx(WAY, abs=0.02) and deepest <= 1e-6
    assert np.sort(moved[:-1])[-1] > 0.05 and np.sort(moved[:-1])[-2] < 1e-6
