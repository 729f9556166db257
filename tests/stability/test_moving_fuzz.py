"""Drawn lifts, turntables and bars, a hand that wanders amid moved bodies, and bodies that it takes and lets go at random.

`python -m tests.stability.test_moving_fuzz --frames 100000 --seed 1` runs so many frames; exit code 1 where something overlapped
or was not finite.
"""

import argparse
import sys
from dataclasses import dataclass, replace

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.simulator import AvatarsimEngine
from avatarsim.tolerances import JUDGED
from reference.judging.judge import Judge
from scenarios.drawn_crowds.kinds import FRAMES, Drawn
from scenarios.drawn_crowds.moved import moved
from scenarios.scenario import RENDERED

EVERY = 15
"""Frames between two things that the hand does."""


@dataclass
class Found:
    """Findings over the frames of drawn scenes: overlap [m], speed [m/s], and how often a body was attached."""

    frames: int = 0
    overlap: float = 0.0
    speed: float = 0.0
    attached: int = 0
    worst: int = -1


def wander(random: np.random.Generator, start: np.ndarray) -> np.ndarray:
    """Return places (frames, 3) of a hand [m]: sums of slow waves that begin at its start."""
    time = np.arange(FRAMES)[:, None] * RENDERED
    size, rate = random.uniform(0.0, 0.25, size=(3, 3)), random.uniform(0.5, 4.0, size=(3, 3))
    waves = sum(size[k] * np.sin(rate[k] * time) for k in range(3))
    waves[:, 2] = 0.6 * np.abs(waves[:, 2])
    return np.asarray(start + waves)


def take_or_let_go(engine: AvatarsimEngine, scene: Scene, random: np.random.Generator) -> int:
    """Release attached bodies, or attach one: one that the hand touches, or any. Return how many were attached."""
    held = list(engine.attached())
    if held:
        engine.detach(held[int(random.integers(len(held)))])
        return 0
    loose = [name for name, role in zip(scene.names, scene.roles, strict=True) if role is Role.SIMULATED]
    touched = [one.a if one.b == "hand" else one.b for one in engine.contacts() if "hand" in (one.a, one.b)]
    choice = [name for name in touched if name in loose] if random.random() < 0.8 else loose
    if not choice:
        return 0
    engine.attach(choice[int(random.integers(len(choice)))], "hand")
    return 1


def run(seed: int, found: Found) -> None:
    """One drawn scene."""
    random = np.random.default_rng([seed, 49])
    crowd = moved(Drawn(f"fuzz_{seed}", random))
    scene, motion = crowd.scene, crowd.motion(crowd.scene, seed)
    places, records = wander(random, scene.first_sample.positions[1]), list[FrameRecord]()
    with AvatarsimEngine() as engine:
        engine.load(scene, Settings(), RENDERED)
        for k in range(FRAMES):
            sample = motion(k)
            positions = sample.positions.copy()
            positions[1] = places[k]
            records.append(engine.advance(replace(sample, positions=positions), RENDERED))
            if k % EVERY == EVERY - 1:
                found.attached += take_or_let_go(engine, scene, random)
    positions = np.array([one.shown.positions for one in records])
    overlap = Judge(scene).deepest(positions, np.array([one.shown.orientations for one in records]))
    if not overlap <= found.overlap:
        found.overlap, found.worst = overlap, seed
    found.speed = max(found.speed, max(float(np.abs(one.shown.velocities).max()) for one in records))
    found.frames += FRAMES


@pytest.mark.parametrize("seed", range(3))
def test_drawn_moving_scenes_overlap_nowhere(seed: int) -> None:
    found = Found()
    run(seed, found)
    assert found.overlap <= JUDGED and np.isfinite(found.speed)


def main() -> int:
    """Run as many scenes as it takes."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--frames", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    found, seed = Found(), asked.seed
    while found.frames < asked.frames:
        run(seed, found)
        seed += 1
    print(f"{found.frames} frames, {found.attached} bodies attached, overlap {found.overlap:.2e} m (seed {found.worst}), "
          f"largest speed {found.speed:.1f} m/s")
    return 0 if found.overlap <= JUDGED and np.isfinite(found.speed) else 1


if __name__ == "__main__":
    sys.exit(main())
