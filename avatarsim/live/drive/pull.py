"""Goals of dragged links, solved by the engine's inverse kinematics; straight elbows and knees are bent beforehand."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import atan2, hypot, sqrt

import numpy as np
from numpy.typing import ArrayLike

from avatarsim.ik.goals import DAMPING, SPENT, Goals, GoalScratch, approach, make_goal_scratch, make_goals, mobility
from avatarsim.live.drive.tree import Array, Poses, Posture, Tree
from avatarsim.scene.joint import MANY_TURNS
from avatarsim.spatial import rotation

NO_LENGTH = 1e-12
"""Length below which a vector has no direction: rounding of unit vectors is 1e-16."""

CLOSE = 1e-5
"""[m] Error, turns scaled by the lever, below which a goal is reached: far below a pixel. Less: rounds without visible effect."""

ROUNDS = 6
"""Rounds of a call: the motion of a goal in a frame takes two or three. More: a goal out of reach would cost more time."""

ONE_SIDED = 0.6
"""[rad] Least middle of the limits of an elbow, a knee or a finger's middle joint; of a spine it is 0.4."""

SHORTENED = 0.01
"""Share of the lever by which a chain must become shorter for its elbow to be bent."""


@dataclass(frozen=True)
class Goal:
    """Goal of a link in the world: its joint's centre [m] and its orientation; None if free."""

    link: int
    position: ArrayLike | None
    orientation: ArrayLike | None = None


@dataclass
class Pull:
    """Links with goals and the joints that move them: all from each link up to its root, except those of `fixed` links.

    `lever` [m] converts a turn of a radian to a length."""

    tree: Tree
    links: tuple[int, ...]
    lever: float
    fixed: frozenset[int] = frozenset()
    joints: list[int] = field(init=False)

    def __post_init__(self) -> None:
        above = sorted({k for link in self.links for k in self.tree.chain(link)})
        self.joints = [k for k in self.tree.moving(above) if k not in self.fixed]

    def error(self, posture: Posture, goals: Sequence[Goal]) -> Array:
        """Return the mean vector from the links to their goals (3,) [m]."""
        places, _ = self.tree.poses(posture)
        missed = [goal.position - places[goal.link] for goal in goals if goal.position is not None]
        return np.asarray(np.mean(missed, axis=0), dtype=np.float64)

    def solve(self, posture: Posture, goals: Sequence[Goal], most: float, still: Sequence[int] = ()) -> bool:
        """Move the posture towards the goals, no joint by more than `most` [rad], and `still` ones not at all.

        Return True if it stopped where more rounds would not help: the goals are out of reach."""
        if not self.joints:
            return True
        arrays, (goal_arrays, scratch, mobile) = self.tree.arrays, self._room
        scratch.mobility[:] = mobile
        for k in still:
            scratch.mobility[arrays.skeleton.first_dof[k] : arrays.skeleton.first_dof[k + 1]] = 0.0
        for g, goal in enumerate(goals):
            goal_arrays.link[g] = goal.link
            goal_arrays.has_place[g], goal_arrays.has_turn[g] = goal.position is not None, goal.orientation is not None
            if goal.position is not None:
                goal_arrays.place[g] = goal.position
            if goal.orientation is not None:
                goal_arrays.turn[g] = rotation.to_matrix(goal.orientation)
        found = arrays.read(posture.sample(0.0))
        is_stuck = approach(arrays.skeleton, goal_arrays, self.lever, CLOSE, ROUNDS, most, DAMPING, found, scratch)
        self.tree.take_over(found, [k for k in self.joints if self.tree.nodes[k].is_ball], posture)
        return is_stuck and not still

    @cached_property
    def _room(self) -> tuple[Goals, GoalScratch, Array]:
        skel = self.tree.arrays.skeleton
        return make_goals(len(self.links)), make_goal_scratch(skel, len(self.links)), mobility(skel, self.joints, self.lever)

    def bend(self, posture: Posture, goals: Sequence[Goal], most: float) -> list[int]:
        """Bend the elbow, or knee, of each chain that is nearly straight and must become shorter, by up to `most` [rad] and
        to the middle of its limits; return the bent joints, which are to be left alone in this frame.

        To first order a straight chain cannot be shortened at all: no linear system finds the direction, and its solution may
        lead to the wrong side. The angle is that of a triangle (law of cosines)."""
        poses, found = self.tree.poses(posture), []
        for goal in goals:
            chain = self.tree.chain(goal.link)
            elbow = self._elbow(chain)
            axis = self._bending(elbow, poses) if elbow >= 0 else None
            if axis is None or goal.position is None:
                continue
            below = chain[chain.index(elbow) + 1 :]
            above, middle, wrist, end = poses[0][[self.tree.nodes[elbow].parent, elbow, below[0], goal.link]]
            # links below the wrist move with it rigidly
            wanted = hypot(*(goal.position + (wrist - end) - above))
            if not wanted < hypot(*(wrist - above)) - SHORTENED * self.lever:
                continue
            upper, lower = middle - above, wrist - middle
            turn = min(exterior_angle(hypot(*upper), hypot(*lower), wanted) - bend_about(axis, upper, lower), most)
            if turn > 0.0 and turn_about(self.tree, posture, elbow, axis, turn, poses) > SPENT * turn:
                found += [k for k in (elbow, *below) if k in self.joints]
        return found

    def _elbow(self, chain: Sequence[int]) -> int:
        """Return the joint of a chain, below its first one, between the longest bones; -1 if there is none."""
        best, longest = -1, 0.0
        for k, after in zip(chain[2:], chain[3:], strict=False):
            shorter = min(hypot(*self.tree.nodes[k].anchor), hypot(*self.tree.nodes[after].anchor))
            if k in self.joints and shorter > longest:
                best, longest = k, shorter
        return best

    def _bending(self, k: int, poses: Poses) -> Array | None:
        """Return the world axis about which a joint bends: from zero to the middle of its limits; None if that is not far."""
        node = self.tree.nodes[k]
        if node.is_ball:
            # axis of the limb and centre of its swing, both in the link's frame at zero
            balls = self.tree.arrays.skeleton.balls
            limb, centre = balls.axis[k], balls.centre[k]
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
    """Turn the joint of a link about an axis in the world, by its hinge nearest to that axis if it has hinges; return the angle
    [rad] that its limits allow."""
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
    """Return the turn [rad] of the second of two bones against the first about an axis."""
    return atan2(float(axis @ rotation.cross(upper, lower)), float(upper @ lower))


def exterior_angle(a: float, b: float, distance: float) -> float:
    """Return the bend [rad] of two bones of lengths a and b [m] whose ends are `distance` apart: 0 straight, pi folded."""
    if not a * b > 0.0:
        return 0.0
    cosine = min(max((distance * distance - a * a - b * b) / (2.0 * a * b), -1.0), 1.0)
    return atan2(sqrt(1.0 - cosine * cosine), cosine)
