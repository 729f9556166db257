"""Inverse kinematics of an avatar for goals of its links.

Levenberg and Marquardt's method on the engine's kinematics and limits: the step of least norm in the joints that no limit stops
(Nakamura and Hanafusa 1986, the singularity-robust inverse), clipped to the limits, taken where it comes nearer to the goals. No
obstacles are known here: the Shield and the engine keep the avatar out of them. A free root stays where it is.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.constraints import add_lever
from avatarsim.ik.make import empty_posture
from avatarsim.model.conversion import read_sample, write_sample
from avatarsim.model.geometry import Poses
from avatarsim.model.joint_limits import cone_excess, has_cone, inside_cone
from avatarsim.model.skeleton import BALL, FREE, Posture, Skeleton, carry, displace, hinge_dofs, skeleton
from avatarsim.model.world import sample_arrays
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial.tangent import columns, put_columns

Array = NDArray[np.float64]

MATERIAL = "human"
"""A material that every scene knows."""

STEPS = 60
"""Steps at most. Fewer: goals out of reach end farther from the nearest posture; a goal in reach takes some ten."""

REACHED = 1e-9
"""[m] a link this near to its goal is there, and steps that come nearer by no more end."""

DAMPING, EASED, RAISED, LEAST, STUCK = 0.03, 0.5, 4.0, 1e-6, 1e3
"""[m] damping at first, its factors after a step that comes nearer and after one that does not, the least, and where it ends.
Less: first steps are long where the arm is stretched; more: they are short everywhere."""

STARTS = 12
"""Postures that are started from, the given one first; then limbs that miss their goals begin anywhere: a joint may be stopped by
its limit on the way to a goal that is in reach from elsewhere. Fewer: such goals are missed; more: those out of reach take
longer."""

LONGEST = 0.5
"""[rad, m] of any joint in a step. More: the arm comes out folded another way; less: more steps."""


class Limb:
    """The links of an avatar, alone in the world."""

    def __init__(self, avatar: Avatar) -> None:
        # shapes and what they are made of play no part
        bare = replace(avatar, links=tuple(replace(link, pieces=(), material=MATERIAL) for link in avatar.links))
        self._skel: Skeleton = skeleton(Scene("reach", (), (bare,)))
        self._hinges = hinge_dofs(self._skel)
        links, degrees = len(avatar.links), int(self._skel.first_dof[-1])
        nothing = np.zeros((0, 3)), np.zeros((0, 6)), np.zeros((0, 6))
        self._poses = Poses(np.zeros((links, 3)), np.zeros((links, 3, 3)), *nothing)
        self._axes, self._still = np.zeros((degrees, 3)), np.zeros(degrees)
        self._joint_of = np.repeat(np.arange(links), np.diff(self._skel.first_dof))
        held = self._skel.kind[self._joint_of] == FREE
        single = np.isin(np.arange(degrees), self._hinges)
        self._moves, self._low, self._high = ~held, *np.where(single, self._skel.limits.T, [[-np.inf], [np.inf]])

    def reach(self, start: TrackerSample, goals: Mapping[int, Array]) -> TrackerSample:
        """Return the posture near `start` with links, by their numbers, as near to their goals (3,) [m] as is found."""
        positions, rotations, angles = (one.copy() for one in sample_arrays(start))
        posture = empty_posture(len(self._poses.position), len(self._still))
        read_sample(positions, rotations, angles, self._hinges, posture)
        rng = np.random.default_rng(0)
        best, missing = self._followed(posture, goals)
        for _ in range(STARTS - 1):
            left = [link for k, link in enumerate(goals) if np.abs(missing[3 * k : 3 * k + 3]).max() > REACHED]
            if not left:
                break
            found, way = self._followed(self._started_again(best, left, rng), goals)
            if float(way @ way) < float(missing @ missing):
                best, missing = found, way
        write_sample(best, self._hinges, positions, rotations, angles)
        return TrackerSample(start.time, positions, rotations, angles)

    def _started_again(self, posture: Posture, links: list[int], rng: np.random.Generator) -> Posture:
        """The posture with the hinges that carry these links anywhere within limits, at most half a turn away."""
        found = Posture(*(one.copy() for one in posture))
        carrying = np.asarray(self._skel.related[links].any(axis=0))[self._joint_of]
        low, high = np.maximum(self._low, posture.angle - np.pi), np.minimum(self._high, posture.angle + np.pi)
        found.angle[carrying] = rng.uniform(low, high)[carrying]
        return found

    def _followed(self, posture: Posture, goals: Mapping[int, Array]) -> tuple[Posture, Array]:
        """The posture where steps from one end, and the ways (3 n) to the goals that are left [m]."""
        posture = self._displaced(posture, self._still)
        missing, damping = self._missing(posture, goals), DAMPING
        for _ in range(STEPS):
            if not np.abs(missing).max(initial=0.0) > REACHED or damping > STUCK:
                break
            nearer = self._displaced(posture, self._step(posture, goals, missing, damping))
            left = self._missing(nearer, goals)
            if float(left @ left) < float(missing @ missing):
                posture, missing, damping = nearer, left, max(LEAST, EASED * damping)
            else:
                damping *= RAISED
        return posture, missing

    def _missing(self, posture: Posture, goals: Mapping[int, Array]) -> Array:
        """(3 n) ways from the links to their goals [m]."""
        carry(self._skel, posture, self._still, self._poses, self._axes)
        return np.concatenate([goal - self._poses.position[link] for link, goal in goals.items()] or [np.zeros(0)])

    def _step(self, posture: Posture, goals: Mapping[int, Array], missing: Array, damping: float) -> Array:
        """Return the damped step (nd) from a posture."""
        self._missing(posture, goals)
        jacobian = np.zeros((len(missing), len(self._still)))
        for k, link in enumerate(goals):
            x, y, z = (float(one) for one in self._poses.position[link])
            for i, n in enumerate(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))):
                add_lever(self._skel, link, 1.0, n, (x, y, z), self._poses, self._axes, 3 * k + i, jacobian)
        pull = jacobian.T @ missing
        stopped = ((posture.angle <= self._low) & (pull < 0.0)) | ((posture.angle >= self._high) & (pull > 0.0))
        jacobian[:, stopped | ~self._moves] = 0.0
        step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping**2 * np.eye(len(missing)), missing)
        return np.asarray(step * min(1.0, LONGEST / max(np.abs(step).max(initial=0.0), REACHED)))

    def _displaced(self, posture: Posture, step: Array) -> Posture:
        """Return a posture after a step, within joint limits."""
        found = Posture(*(one.copy() for one in posture))
        displace(self._skel, found, step)
        found.angle[:] = np.clip(found.angle, self._low, self._high)
        for link in np.flatnonzero(self._skel.kind == BALL).tolist():
            turn = columns(found.turn, link)
            if has_cone(self._skel, link) and cone_excess(self._skel, link, turn) > 0.0:
                put_columns(found.turn, link, inside_cone(self._skel, link, turn))
        return found
