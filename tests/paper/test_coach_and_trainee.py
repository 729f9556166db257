"""Coach and trainee: once a gliding slab has left the user's stretched arm free, the posture returns by the closed forms."""

from math import exp

import numpy as np

from avatarsim.engine import Settings
from avatarsim.settings import AttractionSettings
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog

FREE_FROM, UNTIL = 114, 130
"""Frames in which the slab has passed the arm; its rear edge does so at 1.8 s."""


def returning(preset: str, until: int = UNTIL) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """Return (hinges still to go, hinges to go from the frame before, offset of the root [m]) while nothing is in the way."""
    scenario = catalog.get("coach_release")
    scene, engine = scenario.build(), AvatarsimEngine()
    motion, found = scenario.motion(scene, 0), []
    before = engine.load(scene, Settings(preset), scenario.dt).angles
    for k in range(until):
        sample = motion(k)
        record = engine.advance(sample, scenario.dt)
        if k >= FREE_FROM:
            offset = float(np.linalg.norm(record.shown.positions[len(scene.bodies)] - sample.positions[0]))
            found.append((sample.angles - record.angles, sample.angles - before, offset))
        before = record.angles
    return found


def test_the_papers_attraction_returns_on_its_exponential() -> None:
    """Each frame leaves exp(-rate dt) of the remaining way, whatever the user does meanwhile."""
    share = exp(-AttractionSettings().rate / 60.0)
    found = returning("paper")
    assert np.abs(found[0][1]).max() > 0.01
    for left, before, offset in found:
        np.testing.assert_allclose(left, share * before, rtol=1e-9, atol=1e-12)
        assert offset < 1e-3


def test_the_default_method_returns_by_equation_6() -> None:
    """The arm, folded back by a third of a radian, is back within a fifth of a second; no root is ever thrown."""
    found = returning("default", 190)
    assert max(np.abs(left).max() for left, _, _ in found) < 0.06
    assert max(np.abs(left).max() for left, _, _ in found[6:]) < 0.01
    assert max(np.abs(left).max() for left, _, _ in found[16:]) < 1e-3
    assert max(offset for _, _, offset in found) < 1e-3
