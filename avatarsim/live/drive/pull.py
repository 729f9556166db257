"""Goals of dragged links, solved by the engine's inverse kinematics; straight elbows and knees are bent beforehand."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import atan2, hypot, sqrt

import numpy as np
from numpy.typing import ArrayLike

from avatarsim.ik.goals import SPENT, Goals, GoalScratch, approach, make_goal_scratch, make_goals, mobility
from avatarsim.live.drive.tree import Array, Poses, Posture, Tree
from avatarsim.scene.joint import MANY_TURNS
from avatarsim.spatial import rotation

NO_LENGTH = 1e-12
"""Length below which a vector has no direction: rounding of unit vectors is 1e-16."""

CLOSE = 1e-5
"""[m] error, turns counted by the lever, below which a goal is reached: far below a pixel; less: rounds that nothing shows."""

ROUNDS = 6
"""Rounds of a call: what a goal moves in a frame takes two or three. More: a goal out of reach would cost more time."""

ONE_SIDED = 0.6
"""[rad] from zero to the middle of the limits of an elbow, a knee or a finger's middle joint, at least; of a spine it is 0.4."""

SHORTENED = 0.01
"""By which share of the lever a chain must become shorter for its elbow to be bent."""


@dataclass(frozen=True)
class Goal:
    """Where a link is to be, in the world: its joint's centre [m] and its orientation; None for what may be any."""

    link: int
    position: ArrayLike | None
    orientation: ArrayLike | None = None


@dataclass
class Pull:
    """The goals' links and what moves them: all joints from each up to its root, but for those of links that are `held`.

    `lever` [m] is the length that a turn of a radian counts as."""

    tree: Tree
    links: tuple[int, ...]
    lever: float
    held: frozenset[int] = frozenset()
    joints: list[int] = field(init=False)

    def __post_init__(self) -> None:
        above = sorted({k for link in self.links for k in self.tree.chain(link)})
        self.joints = [k for k in self.tree.moving(above) if k not in self.held]

    def error(self, posture: Posture, goals: Sequence[Goal]) -> Array:
        """The mean way from each link to the place that is its goal (3,) [m]."""
        places, _ = self.tree.poses(posture)
        missed = [goal.position - places[goal.link] for goal in goals if goal.position is not None]
        return np.asarray(np.mean(missed, axis=0), dtype=np.float64)

    def solve(self, posture: Posture, goals: Sequence[Goal], most: float, still: Sequence[int] = ()) -> bool:
        """Move the posture towards the goals, no joint by more than `most` [rad], and `still` ones not at all.

        Returns whether it came to a place from where more of the same would not help: the goals are out of reach."""
        if not self.joints:
            return True
        arrays, (asked, scratch, mobile) = self.tree.arrays, self._room
        scratch.mobility[:] = mobile
        for k in still:
            scratch.mobility[arrays.skeleton.first_dof[k] : arrays.skeleton.first_dof[k + 1]] = 0.0
        for g, goal in enumerate(goals):
            asked.link[g] = goal.link
            asked.has_place[g], asked.has_turn[g] = goal.position is not None, goal.orientation is not None
            if goal.position is not None:
                asked.place[g] = goal.position
            if goal.orientation is not None:
                asked.turn[g] = rotation.to_matrix(goal.orientation)
        found = arrays.read(posture.sample(0.0))
        is_stuck = approach(arrays.skeleton, asked, self.lever, CLOSE, ROUNDS, most, found, scratch)
        self.tree.take_over(found, [k for k in self.joints if self.tree.nodes[k].is_ball], posture)
        return is_stuck and not still

    @cached_property
    def _room(self) -> tuple[Goals, GoalScratch, Array]:
        skel = self.tree.arrays.skeleton
        return make_goals(len(self.links)), make_goal_scratch(skel, len(self.links)), mobility(skel, self.joints, self.lever)

    def bend(self, posture: Posture, goals: Sequence[Goal], most: float) -> list[int]:
        """Bend the elbow, or knee, of each chain that is nearly straight and must become shorter, by up to `most` [rad] and to
        the middle of its limits; the joints that were, which are to be left alone in this frame.

        To first order a straight chain cannot be shortened at all: no system that is linear finds the way, and what it finds
        leads as easily to the wrong side. The angle is that of a triangle (law of cosines)."""
        poses, found = self.tree.poses(posture), []
        for goal in goals:
            chain = self.tree.chain(goal.link)
            elbow = self._elbow(chain)
            axis = self._bending(elbow, poses) if elbow >= 0 else None
            if axis is None or goal.position is None:
                continue
            below = chain[chain.index(elbow) + 1 :]
            above, middle, wrist, end = poses[0][[self.tree.nodes[elbow].parent, elbow, below[0], goal.link]]
            # what is below the wrist goes along as it is
            wanted = hypot(*(goal.position + (wrist - end) - above))
            if not wanted < hypot(*(wrist - above)) - SHORTENED * self.lever:
                continue
            upper, lower = middle - above, wrist - middle
            turn = min(exterior_angle(hypot(*upper), hypot(*lower), wanted) - bend_about(axis, upper, lower), most)
            if turn > 0.0 and turn_about(self.tree, posture, elbow, axis, turn, poses) > SPENT * turn:
                found += [k for k in (elbow, *below) if k in self.joints]
        return found

    def _elbow(self, chain: Sequence[int]) -> int:
        """The joint of a chain, below its first one, between the longest bones; -1 where there is none."""
        best, longest = -1, 0.0
        for k, after in zip(chain[2:], chain[3:], strict=False):
            shorter = min(hypot(*self.tree.nodes[k].anchor), hypot(*self.tree.nodes[after].anchor))
            if k in self.joints and shorter > longest:
                best, longest = k, shorter
        return best

    def _bending(self, k: int, poses: Poses) -> Array | None:
        """The axis in the world about which a joint bends: from zero to the middle of its limits; None where that is not far."""
        node = self.tree.nodes[k]
        if node.is_ball:
            # axis of the limb and centre of its swing, both in the link's frame at zero
            limb, centre = self.tree.arrays.skeleton.cone[k, :3], self.tree.arrays.skeleton.cone[k, 3:6]
            across = rotation.cross(limb, centre)
            length = hypot(*across)
            if atan2(length, float(limb @ centre)) < ONE_SIDED or length < NO_LENGTH:
                return None
            return rotation.rotate(self.tree.above(k, poses), across / length)
        if node.is_slide:
            return None
        middle = 0.5 * (node.hinges[0].lower + node.hinges[0].upper) if len(node.hinges) == 1 else 0.0
        if not ONE_SIDED < abs(middle) < MANY_TURNS:
            return None
        return rotation.rotate(self.tree.above(k, poses), np.multiply(node.hinges[0].axis, 1.0 if middle > 0.0 else -1.0))


def turn_about(tree: Tree, posture: Posture, k: int, axis: Array, angle: float, poses: Poses) -> float:
    """Turn the joint of a link about an axis in the world, by the hinge that is nearest to it if it has hinges; the angle [rad]
    that its limits leave of it."""
    node, above = tree.nodes[k], tree.above(k, poses)
    if node.is_ball:
        was = posture.turns[k].copy()
        posture.turns[k] = rotation.turned(was, angle * rotation.rotate(rotation.conjugate(above), axis))
        tree.clip(posture)
        return hypot(*rotation.difference(was, posture.turns[k]))
    along = [] if node.is_slide else [float(rotation.rotate(above, hinge.axis) @ axis) for hinge in node.hinges]
    best = max(range(len(along)), key=lambda h: abs(along[h]), default=-1)
    if best < 0:
        return 0.0
    hinge, at = node.hinges[best], node.first_angle + best
    before = float(posture.angles[at])
    posture.angles[at] = min(max(before + (angle if along[best] > 0.0 else -angle), hinge.lower), hinge.upper)
    return abs(float(posture.angles[at]) - before)


def bend_about(axis: Array, upper: Array, lower: Array) -> float:
    """[rad] by which the second of two bones is turned against the first about an axis."""
    return atan2(float(axis @ rotation.cross(upper, lower)), float(upper @ lower))


def exterior_angle(a: float, b: float, distance: float) -> float:
    """[rad] by which two bones of lengths a and b [m] are bent when their ends are so far apart: 0 straight, pi folded."""
    if not a * b > 0.0:
        return 0.0
    cosine = min(max((distance * distance - a * a - b * b) / (2.0 * a * b), -1.0), 1.0)
    return atan2(sqrt(1.0 - cosine * cosine), cosine)
