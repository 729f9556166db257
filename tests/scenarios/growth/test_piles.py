"""Piles: as many contacts as their names say, no overlap at the start, what stands stays, what falls lands, no body sleeps."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from reference.judging.judge import Judge
from scenarios.growth import worlds
from scenarios.growth.piles import DROP, MODES, SPEED, rows_for


@pytest.mark.parametrize("contacts", worlds.CONTACTS)
def test_a_pyramid_has_four_points_per_square_of_its_rows(contacts: int) -> None:
    rows = rows_for(contacts)
    bodies = worlds.get(f"contacts_{contacts}_standing").build().bodies
    assert len(bodies) == 1 + rows * (rows + 1) // 2
    assert 4 * rows * rows >= contacts > 4 * (rows - 1) * (rows - 1)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("contacts", (1, 10, 100))
def test_it_keeps_its_contacts_and_overlaps_nothing(contacts: int, mode: str) -> None:
    scenario = worlds.get(f"contacts_{contacts}_{mode}")
    scene = scenario.build()
    motion, engine, judge = scenario.motion(scene, 0), AvatarsimEngine(), Judge(scene)
    first = engine.load(scene, Settings(), scenario.dt)
    found = [engine.advance(motion(k), scenario.dt) for k in range(scenario.frames)]
    shown = [first, *found[::5], found[-1]]
    assert max(judge.overlaps(r.shown.positions, r.shown.orientations).deepest for r in shown) <= 1e-6
    moved = found[-1].shown.positions - first.shown.positions
    if mode == "rolling":
        np.testing.assert_allclose(moved[1:, 0], SPEED * scenario.frames * scenario.dt, rtol=1e-6)
        assert max(record.counts["contacts"] for record in found) >= 1
    elif mode == "standing":
        np.testing.assert_allclose(moved, 0.0, atol=1e-6)
        assert min(record.counts["contacts"] for record in found) >= contacts
    else:
        assert moved[:, 2].min() == pytest.approx(-DROP * rows_for(contacts), abs=1e-3)
        assert max(record.counts["contacts"] for record in found) >= min(contacts, 4)
        # a body at rest is looked at once: a load that wandered from corner to corner took 125,000
        assert found[-1].counts["work"] < 20 * max(contacts, 4)
