"""At a tracker that rests, wherever it rests, nothing moves more than a millimetre per frame after seven seconds.

Until then the catch-up speeds fall with the low-passed speed of the target, and limbs that hold each other may go to and fro.

What goes along a way out of a trap is another thing: its frames say `following`, and it ends.
"""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from tests.stability.hostile import DT, TRIALS, hostile_motion

AWAY, HOME = 60, 30
"""Frames of a hostile stretch and of the rest at home after it."""
STILL, LATER = 430, 60
"""Frames at rest after which nothing may move, and for which it is then watched."""


def moved(name: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Largest way [m] of a link's origin in every frame at rest, and whether the avatar was led in it."""
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
    for seed in range(12):
        ways, led = moved(name, seed)
        late.append(float(ways[STILL:][~led[STILL:]].max()))
        early.append(float(ways[:STILL].max()))
    assert max(late) <= 1e-3
    # it is no freeze: just after the stop limbs still go where they are wanted
    assert max(early) > 1e-2
