"""Limbs that a resting user presses into a wall may look for a better place to rest, but not whip there."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog

AT_REST = 0.05
"""[degrees] a tracker whose joints turn less than this in a frame is at rest."""
MOST = 15.0
"""[degrees] turn of a link in a frame of a resting tracker; it was 70 when stuck limbs began anew with full trust."""


@pytest.mark.parametrize("name", ["two_arms", "two_arms_and_leg"])
def test_no_link_whips_while_the_user_rests(name: str) -> None:
    scenario = catalog.get(name)
    scene = scenario.build()
    motion = (scenario.short_motion or scenario.motion)(scene, 0)
    engine, first = AvatarsimEngine(), len(scene.bodies)
    engine.load(scene, Settings(), scenario.dt)
    start = scene.first_sample
    before, wanted_before, angles_before = None, Rotation.from_quat(start.rotations, scalar_first=True), start.angles
    resting, largest = 0, 0.0
    for k in range(400):
        sample = motion(k)
        shown = Rotation.from_quat(engine.advance(sample, scenario.dt).shown.orientations[first:], scalar_first=True)
        wanted = Rotation.from_quat(sample.rotations, scalar_first=True)
        asked = float(np.degrees((wanted_before.inv() * wanted).magnitude()).max())
        asked = max(asked, float(np.degrees(np.abs(sample.angles - angles_before).max())))
        if before is not None and asked < AT_REST:
            resting += 1
            largest = max(largest, float(np.degrees((before.inv() * shown).magnitude()).max()))
        before, wanted_before, angles_before = shown, wanted, sample.angles
    assert resting > 50
    assert 0.0 < largest <= MOST
