"""A stack of boxes of 0.2 mm stands in MuJoCo as one of 0.2 m does: its solver may not end where forces are small."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from reference.in_mujoco.engine import MujocoEngine
from scenarios import catalog
from scenarios.building.small_world import STACK
from tests.agreement.scenes import nobody


def drift(name: str, options: dict[str, object]) -> float:
    """Largest way [m] of a box of the stack within half a second."""
    scenario = catalog.get(name)
    scene, engine = scenario.build(), MujocoEngine()
    boxes = [scene.names.index(box) for box in STACK]
    first = engine.load(scene, Settings("tuned", options), scenario.dt).shown.positions[boxes]
    for frame in range(30):
        shown = engine.advance(nobody(scene, frame), scenario.dt).shown
    engine.close()
    return float(np.abs(shown.positions[boxes] - first).max())


@pytest.mark.parametrize(("name", "edge"), [("scale_mm", 2e-4), ("scale_km", 2e2)])
def test_it_stands(name: str, edge: float) -> None:
    assert drift(name, {}) < 1e-3 * edge


def test_by_default_it_falls_apart() -> None:
    """The trap is real."""
    assert drift("scale_mm", {"tolerance": 1e-8}) > 0.01 * 2e-4
