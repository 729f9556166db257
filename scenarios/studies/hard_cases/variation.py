"""One change of a case, or several at once, and the case changed by it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Body, Role
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.motion.between import between
from scenarios.scenario import RENDERED, Motion, Scenario
from scenarios.studies.hard_cases.elsewhere import Elsewhere

Array = NDArray[np.float64]

WAY = (0.6, -0.8, 0.0)
"""Direction in which a world is moved away."""


@dataclass(frozen=True)
class Variation:
    """Changes of a case. `start` [m] by how much every body's first place, and the user's way, are off; `seed` of that draw
    and of the engine; `user` the seed of the user's motion; `dt` [s] frame time; `scale` size; `far` distance of the origin, in
    metres of a world of size 1: a thousandth as large, it is moved a thousandth as far, so that rounding is as large a part.
    `step` length of the engine's solver step in steps of its preset."""

    start: float = 0.0
    seed: int = 0
    user: int = 0
    dt: float = RENDERED
    scale: float = 1.0
    far: float = 0.0
    step: float = 1.0

    @property
    def elsewhere(self) -> Elsewhere:
        """Place of the world."""
        x, y, z = (self.scale * self.far * part for part in WAY)
        return Elsewhere(self.scale, rotation.IDENTITY, (x, y, z))


@dataclass(frozen=True, eq=False)
class Varied:
    """A case as it is run: `scene` and `samples` of every frame of `dt` [s], and `here`, the scene before it was moved."""

    scene: Scene
    samples: Sequence[TrackerSample]
    dt: float
    here: Scene


def varied(scenario: Scenario, seconds: float, change: Variation) -> Varied:
    """Return `scenario` for `seconds`, changed; whole frames of about `change.dt`, so that all runs end at one time."""
    frames = max(1, round(seconds / change.dt))
    dt = seconds / frames
    built = scenario.build()
    motion = scenario.motion(built, change.user)
    samples = [at_time(built, motion, scenario.dt, (k + 1) * dt) for k in range(frames)]
    random = np.random.default_rng((change.seed, 1))
    aside = change.start * _direction(random)
    here = replace(
        built, bodies=spread_out(built.bodies, change.start, random),
        start=None if built.start is None else moved(built.start, aside),
    )
    there = change.elsewhere
    shifted = [moved(sample, aside) for sample in samples] if change.start else samples
    return Varied(
        there.scene(here), [there.sample(sample, here.avatars) for sample in shifted] if not there.here else shifted, dt, here
    )


def _direction(random: np.random.Generator) -> Array:
    way = random.normal(size=3)
    return np.asarray(way / np.linalg.norm(way))


def moved(sample: TrackerSample, aside: Array) -> TrackerSample:
    """Return the user a little aside; only roots have a place in the world."""
    return replace(sample, positions=sample.positions + aside)


def spread_out(bodies: tuple[Body, ...], start: float, random: np.random.Generator) -> tuple[Body, ...]:
    """Return simulated bodies moved by up to `start` [m] along each axis, at random, more the farther along it they are.

    In that order no body is moved nearer to another, so stacks and cradles that touch begin free of overlap again.
    """
    own = [k for k, body in enumerate(bodies) if body.role is Role.SIMULATED]
    if not start or not own:
        return bodies
    places = np.array([bodies[k].position for k in own])
    shift = np.empty_like(places)
    for axis in range(3):
        ranks = np.argsort(np.argsort(places[:, axis], kind="stable"), kind="stable")
        shift[:, axis] = start * (ranks + random.uniform(size=len(own))) / len(own)
    new = list(bodies)
    for k, (x, y, z) in zip(own, (places + shift).tolist(), strict=True):
        place: Vector = (x, y, z)
        new[k] = replace(bodies[k], position=place)
    return tuple(new)


def at_time(scene: Scene, motion: Motion, step: float, time: float) -> TrackerSample:
    """Return the user's sample at `time` [s] of a motion given every `step` [s]: between two samples, in proportion."""
    frames = time / step
    before = int(np.floor(frames + 1e-9))
    share = frames - before
    if share < 1e-9:
        return replace(motion(before - 1), time=time) if before else replace(scene.first_sample, time=time)
    return replace(between(motion(before - 1) if before else scene.first_sample, motion(before), share), time=time)
