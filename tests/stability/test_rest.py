"""At a tracker that rests nothing moves more than a millimetre per frame after seven seconds, and no limb whips."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog
from tests.stability.hostile import DT, TRIALS, hostile_motion

AWAY, HOME = 60, 30
"""Frames of a hostile stretch and of the rest at home after it."""
STILL, LATER = 430, 60
"""Frames at rest after which nothing may move, and for which it is then watched."""


def moved(name: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest way [m] of a link's origin in every frame at rest, and whether the avatar was led in it."""
    trial, rng = TRIALS[name](), np.random.default_rng(seed)
    first, engine = len(trial.scene.bodies), AvatarsimEngine()
    record = engine.load(trial.scene, Settings(seed=seed), DT)
    frames = (AWAY + HOME) * int(rng.integers(0, 5)) + int(rng.integers(10, AWAY - 1))
    last = trial.home
    for _, last in islice(hostile_motion(trial, seed, AWAY, HOME), frames):
        record = engine.advance(last, DT)
    ways, led, before = [], [], record.shown.positions[first:].copy()
    for k in range(STILL + LATER):
        record = engine.advance(replace(last, time=last.time + (k + 1) * DT), DT)
        here = record.shown.positions[first:].copy()
        ways.append(float(np.linalg.norm(here - before, axis=1).max()))
        led.append(record.counts["following"] > 0)
        before = here
    return np.array(ways), np.array(led)


@pytest.mark.parametrize("name", sorted(TRIALS))
def test_nothing_wanders_at_a_resting_tracker(name: str) -> None:
    early, late = [], []
    for seed in range(6):
        ways, led = moved(name, seed)
        late.append(float(ways[STILL:][~led[STILL:]].max()))
        early.append(float(ways[:STILL].max()))
    assert max(late) <= 1e-3
    # it is no freeze: just after the stop limbs still go where they are wanted
    assert max(early) > 1e-2


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
