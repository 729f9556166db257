"""Resampling of a tracker's motion to another frame rate: linear between samples, rotations on the great circle (slerp)."""

import math
from collections.abc import Callable
from dataclasses import replace

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, between
from scenarios.scenario import Motion, Scenario

HEADSET = 90
"""Frames per second of a usual headset."""
ROUNDING = 1e-9
"""Share of a frame by which a sample of the new rate may miss one of the old and is still that one."""


def resampled(motion: Motion, start: TrackerSample, old: float, new: float) -> Motion:
    """Return `motion`, whose frames take `old` [s], in frames of `new` [s]; at time 0 its user is at `start`."""

    def at(frame: int) -> TrackerSample:
        return start if frame < 0 else motion(frame)

    def sample(frame: int) -> TrackerSample:
        time = (frame + 1) * new
        before = math.floor(time / old - 1.0 + ROUNDING)
        share = time / old - 1.0 - before
        if share <= ROUNDING:
            return replace(at(before), time=time)
        return replace(between(at(before), at(before + 1), share), time=time)

    return sample


def at_rate(scenario: Scenario, hertz: int = HEADSET) -> Scenario:
    """Return the scenario at another frame rate, as long in seconds, with its bounds, in its family.

    It is another question to an engine that counts frames, or whose step does not divide them.
    """
    name, dt = f"{scenario.name}_{hertz}hz", 1.0 / hertz

    def rated(motion: Callable[[Scene, int], Motion]) -> Callable[[Scene, int], Motion]:
        return lambda scene, seed: resampled(motion(scene, seed), scene.first_sample, scenario.dt, dt)

    def frames(number: int) -> int:
        return round(number * scenario.dt / dt)

    return replace(
        scenario, name=name, title=f"{scenario.title.removesuffix('.')}, at {hertz} Hz.",
        build=lambda: replace(scenario.build(), name=name), dt=dt,
        motion=rated(scenario.motion), frames=frames(scenario.frames),
        short=None if scenario.short is None else frames(scenario.short),
        short_motion=None if scenario.short_motion is None else rated(scenario.short_motion),
        everyday=False, family=scenario.family or scenario.name,
    )
