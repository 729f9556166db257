"""Targets of a driven engine inside a frame: the posture between two tracker samples.

Every reference engine takes steps shorter than a frame. Each step gets the same motion as all others see,
taken between the samples at the two ends of the frame: linear for positions and hinge angles, spherical for
rotations.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.scene.joint import Ball, Free, Hinges, Slide, axes_of
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from reference.target_kernels import (
    FREE,
    MOVED,
    RIGID,
    SLID,
    TURNED,
    chain_poses,
    clamp_balls,
    extrapolate,
    interpolate,
    turned_on,
)

Array = NDArray[np.float64]

ROUNDING = 1e-9
"""Difference of two quaternions from which on they are two."""


@dataclass(frozen=True, eq=False)
class Goals:
    """Postures at `n` instants: as joints and as link poses in the world.

    roots (n, links, 3), turns (n, links, 4), angles (n, hinges); positions (n, links, 3), orientations (n,
    links, 4).
    """

    roots: Array
    turns: Array
    angles: Array
    positions: Array
    orientations: Array


class Targets:
    """Interpolates tracker samples of one scene and turns them into link poses.

    With `clamp` the samples are first brought within hinge limits and swing and twist limits: a servo whose target
    is within the joint's range does not fight the joint's stop.
    """

    def __init__(self, scene: Scene, clamp: bool) -> None:
        links, self._clamp = scene.links, clamp
        names = [(avatar.name, link.name) for avatar in scene.avatars for link in avatar.links]
        index = {name: k for k, name in enumerate(names)}
        joints = [link.joint for link in links]
        hinges = [axes_of(joint) for joint in joints]
        parents = [(avatar.name, link.parent) for avatar in scene.avatars for link in avatar.links]
        self._parent = np.array([-1 if p[1] is None else index[p[0], p[1]] for p in parents], dtype=np.int64)
        self._kind = np.array([_kind(joint) for joint in joints], dtype=np.int64)
        self._anchor = np.array([link.anchor for link in links], dtype=np.float64).reshape(-1, 3)
        self._rest = np.array([link.orientation for link in links], dtype=np.float64).reshape(-1, 4)
        self._first = np.concatenate([[0], np.cumsum([len(h) for h in hinges])]).astype(np.int64)
        flat = [hinge for group in hinges for hinge in group]
        self._axes = np.array([hinge.axis for hinge in flat], dtype=np.float64).reshape(-1, 3)
        self._lower = np.array([hinge.lower for hinge in flat], dtype=np.float64)
        self._upper = np.array([hinge.upper for hinge in flat], dtype=np.float64)
        limited = [(k, j.limits) for k, j in enumerate(joints) if isinstance(j, Ball) and j.limits is not None]
        self._balls = np.array([k for k, _ in limited], dtype=np.int64)
        self._axis = np.array([limit.axis for _, limit in limited], dtype=np.float64).reshape(-1, 3)
        pairs = [rotation.between(limit.axis, limit.centre) for _, limit in limited]
        self._between = np.array(pairs, dtype=np.float64).reshape(-1, 4)
        stops = [(limit.swing, *limit.twist) for _, limit in limited]
        self._stops = np.array(stops, dtype=np.float64).reshape(-1, 3)

    def within_limits(self, sample: TrackerSample) -> TrackerSample:
        """Return `sample` with hinge angles, swings and twists at their limits where they were beyond; unchanged
        without `clamp`."""
        turns = np.array(sample.rotations, dtype=np.float64).reshape(-1, 4)
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        roots = np.array(sample.positions, dtype=np.float64).reshape(-1, 3)
        angles = np.array(sample.angles, dtype=np.float64)
        if self._clamp:
            angles = np.clip(angles, self._lower, self._upper)
            clamp_balls(self._balls, self._rest, self._axis, self._between, self._stops, turns)
        return TrackerSample(sample.time, roots, turns, angles)

    def between(self, start: TrackerSample, end: TrackerSample, fractions: Array) -> Goals:
        """Return postures at `fractions` (n,) of the way from `start` (0) to `end` (1); beyond 1 the motion goes on
        as it was.

        Both samples come from `within_limits`.
        """
        n, links = len(fractions), len(self._parent)
        goals = Goals(
            np.empty((n, links, 3)), np.empty((n, links, 4)), np.empty((n, len(end.angles))),
            np.empty((n, links, 3)), np.empty((n, links, 4)),
        )
        interpolate(
            start.positions, start.rotations, start.angles, end.positions, end.rotations, end.angles, fractions,
            goals.roots, goals.turns, goals.angles,
        )
        chain_poses(
            self._parent, self._kind, self._anchor, self._rest, self._first, self._axes,
            goals.roots, goals.turns, goals.angles, goals.positions, goals.orientations,
        )
        return goals

    def posture(self, sample: TrackerSample) -> tuple[Array, Array]:
        """Return link poses (links, 3) [m] and (links, 4) of one sample, which comes from `within_limits`."""
        positions, orientations = np.empty_like(sample.positions), np.empty_like(sample.rotations)
        chain_poses(
            self._parent, self._kind, self._anchor, self._rest, self._first, self._axes,
            sample.positions[None], sample.rotations[None], sample.angles[None], positions[None], orientations[None],
        )
        return positions, orientations

    def ahead(self, goals: Goals, steps: float, stop: bool = False) -> tuple[Array, Array]:
        """Return link poses (n - 1, links, 3 and 4) `steps` ahead of each posture but the first, at the velocity it
        came with.

        A critically damped follower that is led by its own lag has none in steady motion. No future sample is
        used. With `stop` no link is led beyond a limit: links are where they would be if every joint went on, moved as joints
        that stop at their limits would move them.
        """
        positions, orientations = np.empty_like(goals.positions[1:]), np.empty_like(goals.orientations[1:])
        extrapolate(goals.positions, goals.orientations, steps, positions, orientations)
        if stop and self._clamp and steps > 0.0 and len(positions):
            start, end = (TrackerSample(0.0, goals.roots[k], goals.turns[k], goals.angles[k]) for k in (0, -1))
            fractions = (np.arange(1, len(goals.roots)) + steps) / (len(goals.roots) - 1)
            # a link that is not beyond at last is nowhere beyond, and most never are
            if self._beyond(self.between(start, end, fractions[-1:])):
                self._stop(self.between(start, end, fractions), positions, orientations)
        return positions, orientations

    def _beyond(self, goals: Goals) -> bool:
        """Return True if the first posture is beyond a limit."""
        nearest = self.within_limits(TrackerSample(0.0, goals.roots[0], goals.turns[0], goals.angles[0]))
        return bool((nearest.angles != goals.angles[0]).any() or np.abs(nearest.rotations - goals.turns[0]).max() > ROUNDING)

    def _stop(self, goals: Goals, positions: Array, orientations: Array) -> None:
        """Move poses by the change that limits make to `goals`, which go beyond them."""
        for k in range(len(positions)):
            nearest = self.within_limits(TrackerSample(0.0, goals.roots[k], goals.turns[k], goals.angles[k]))
            there, turned = self.posture(nearest)
            back = rotation.multiply(turned, rotation.conjugate(goals.orientations[k]))
            positions[k] = there + rotation.rotate(back, positions[k] - goals.positions[k])
            orientations[k] = rotation.multiply(back, orientations[k])


class Followed:
    """Turns of some links as an engine that leads them by a share of each step's turn states them: left turn right."""

    def __init__(self, links: Sequence[int], left: ArrayLike, right: ArrayLike) -> None:
        self._links = np.array(links, dtype=np.int64)
        self._left, self._right = (np.array(frames, dtype=np.float64).reshape(-1, 4) for frames in (left, right))

    def aimed(self, turns: Array, share: float) -> Array:
        """Return (n - 1, links, 4) of `turns` (n, all links, 4): each of the second and later, `share` of the way to it from the
        one before it, beyond 1 as far past it."""
        turned = np.empty((len(turns) - 1, len(self._links), 4))
        turned_on(turns, self._links, share, self._left, self._right, turned)
        return turned


def _kind(joint: object) -> int:
    if isinstance(joint, Free):
        return FREE
    if isinstance(joint, Ball):
        return TURNED
    if isinstance(joint, Slide):
        return SLID
    return MOVED if isinstance(joint, Hinges) else RIGID
