"""Damped least squares inverse kinematics within joint limits (Wampler 1986; Buss 2004; damped by the error, Sugihara 2011).

Goals of several links are one stacked system. After a round each joint is projected into its limits. Turns in the direction of
what its limits took away then cost more in the other rounds of that call, so that the rest of the chain does what it cannot do
(weighted least norm, Chan and Dubey 1995). The cost is a continuous function of the share that was taken away: a projection that
changes a turn by its rounding alone stops no joint.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import atan2, hypot, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.live.drive.limits import INWARD, Limits, inside
from avatarsim.live.drive.tree import Posture, Tree
from avatarsim.live.drive.turns import (
    NO_LENGTH,
    ZERO,
    add,
    conjugate,
    cross,
    dot,
    exp,
    multiply,
    norm,
    normalised,
    rotate,
    scaled,
    shortened,
    sub,
    turned_by,
    way,
)
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.joint import MANY_TURNS

Array = NDArray[np.float64]

CLOSE = 1e-5
"""[m] error, turns counted by the lever, below which a goal is reached: far below a pixel; less: rounds that nothing shows."""

ROUNDS = 6
"""Rounds of a call: what a goal moves in a frame takes two or three. More: a goal out of reach would cost more time."""

DAMPING = 1e-4
"""Least damping as a share of the squared lever. Less: a stretched limb turns about its own axis; more: slower near a goal."""

STALLED = 0.95
"""Share of the error before a round above which that round did not help: limits, or the length of the limb, hold it back."""

SPENT = 1e-3
"""Share of what joints may turn in a call below which nothing is left of it."""

STEEPEST = 0.6
"""[rad] largest turn of a joint in a round: the linear model of a turn is off by 6 % there."""


ONE_SIDED = 0.6
"""[rad] from zero to the middle of the limits of an elbow, a knee or a finger's middle joint, at least; of a spine it is 0.4."""

SHORTENED = 0.01
"""By which share of the lever a chain must become shorter for its elbow to be bent."""

STOPPED = 0.25
"""Share of a turn from which on a joint whose limits take it away counts as stopped. Larger: joints at limits are asked again in
vain; smaller: more of a rounding error comes into the posture."""

LEAST_FREE = 1e-3
"""Share of its freedom that a stopped joint keeps, so that no system is singular."""

Axes = tuple[Vector, Vector, Vector]

AXES: Axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Goal:
    """Where a link is to be, in the world: its joint's centre [m] and its orientation; None for what may be any."""

    link: int
    position: Vector | None
    orientation: Quaternion | None = None


@dataclass
class Pull:
    """The goals' links and what moves them: all joints from each up to its root, but for those of links that are `held`.

    `lever` [m] is the length that a turn of a radian counts as."""

    tree: Tree
    links: tuple[int, ...]
    lever: float
    held: frozenset[int] = frozenset()
    needed: list[int] = field(init=False)
    joints: list[int] = field(init=False)
    chains: list[frozenset[int]] = field(init=False)

    def __post_init__(self) -> None:
        ways = [self.tree.chain(link) for link in self.links]
        self.chains = [frozenset(way) for way in ways]
        self.needed = sorted(set().union(*self.chains))
        self.joints = [k for k in self.tree.moving(self.needed) if k not in self.held]

    def errors(self, posture: Posture, goals: Sequence[Goal]) -> list[Vector]:
        """From each link to the place that is its goal [m]."""
        poses = self.tree.poses(posture, self.needed)
        return [sub(goal.position, poses[goal.link][0]) for goal in goals if goal.position is not None]

    def solve(self, posture: Posture, goals: Sequence[Goal], most: float, still: Sequence[int] = ()) -> bool:
        """Move the posture towards the goals, no joint by more than `most` [rad], and `still` ones not at all.

        Returns whether it came to a place from where more of the same would not help: the goals are out of reach."""
        if not self.joints:
            return True
        left, before, begun = most, inf, list(posture.turns)
        nodes = self.tree.nodes
        free: dict[int, Axes] = {k: (ZERO, ZERO, ZERO) if k in still else AXES for k in self.joints if nodes[k].is_ball}
        slack = {h: 0.0 if k in still else 1.0 for k in self.joints for h, _ in enumerate(nodes[k].hinges, nodes[k].first_angle)}
        for _ in range(ROUNDS):
            poses = self.tree.poses(posture, self.needed)
            error = self._error(poses, goals)
            size = float(np.sqrt(error @ error))
            if size < CLOSE:
                return False
            if size > STALLED * before:
                return not still
            before = size
            owners, jacobian = self._jacobian(posture, poses, goals, free, slack)
            gram = jacobian @ jacobian.T
            gram[np.diag_indices_from(gram)] += 0.5 * size * size + DAMPING * self.lever * self.lever
            step = jacobian.T @ np.linalg.solve(gram, error)
            largest = _largest(owners, step.tolist())
            step *= min(1.0, min(left, STEEPEST) / max(largest, 1e-300))
            # what a limit takes away is not spent
            left -= self._apply(posture, poses, owners, step.tolist(), free, slack)
            if left <= SPENT * most:
                self._hold_back(posture, begun, most)
                return False
        return False

    def bend(self, posture: Posture, goals: Sequence[Goal], most: float) -> list[int]:
        """Bend the elbow, or knee, of each chain that is nearly straight and must become shorter, by up to `most` [rad] and to
        the middle of its limits; the joints that were, which are to be left alone in this frame.

        To first order a straight chain cannot be shortened at all: no system that is linear finds the way, and what it finds
        leads as easily to the wrong side. The angle is that of a triangle (law of cosines)."""
        poses, found = self.tree.poses(posture, self.needed), []
        for goal in goals:
            chain = self.tree.chain(goal.link)
            elbow = self._elbow(chain)
            axis = self._bending(elbow, poses) if elbow >= 0 else None
            if axis is None or goal.position is None:
                continue
            below = chain[chain.index(elbow) + 1 :]
            above, middle, wrist = poses[self.tree.nodes[elbow].parent][0], poses[elbow][0], poses[below[0]][0]
            upper, lower = sub(middle, above), sub(wrist, middle)
            # what is below the wrist goes along as it is
            wanted = norm(sub(add(goal.position, sub(wrist, poses[goal.link][0])), above))
            if not wanted < norm(sub(wrist, above)) - SHORTENED * self.lever:
                continue
            bent = atan2(dot(axis, cross(upper, lower)), dot(upper, lower))
            turn = min(exterior_angle(norm(upper), norm(lower), wanted) - bent, most)
            if turn > 0.0 and turn_about(self.tree, posture, elbow, axis, turn, poses) > SPENT * turn:
                found += [k for k in (elbow, *below) if k in self.joints]
        return found

    def _elbow(self, chain: Sequence[int]) -> int:
        """The joint of a chain, below its first one, between the longest bones; -1 where there is none."""
        best, longest = -1, 0.0
        for k, after in zip(chain[2:], chain[3:], strict=False):
            shorter = min(norm(self.tree.nodes[k].anchor), norm(self.tree.nodes[after].anchor))
            if k in self.joints and shorter > longest:
                best, longest = k, shorter
        return best

    def _bending(self, k: int, poses: dict[int, tuple[Vector, Quaternion]]) -> Vector | None:
        """The axis in the world about which a joint bends: from zero to the middle of its limits; None where that is not far."""
        node = self.tree.nodes[k]
        if node.limits is not None:
            limb = rotate(node.orientation, node.limits.axis)
            across = cross(limb, node.limits.centre)
            if atan2(norm(across), dot(limb, node.limits.centre)) < ONE_SIDED or norm(across) < NO_LENGTH:
                return None
            # the parent's axes; `above` is turned on by the link's own rest
            return rotate(poses[node.parent][1], scaled(across, 1.0 / norm(across)))
        if node.is_slide:
            return None
        middle = 0.5 * (node.hinges[0].lower + node.hinges[0].upper) if len(node.hinges) == 1 else 0.0
        if not ONE_SIDED < abs(middle) < MANY_TURNS:
            return None
        return rotate(self.tree.above(k, poses), scaled(node.hinges[0].axis, 1.0 if middle > 0.0 else -1.0))

    def _hold_back(self, posture: Posture, begun: Sequence[Quaternion], most: float) -> None:
        """Take back what balls have turned beyond `most` [rad], which a projection into limits may add."""
        for k in self.joints:
            turn = way(begun[k], posture.turns[k])
            if norm(turn) > most:
                node = self.tree.nodes[k]
                posture.turns[k] = allowed(node.limits, node.orientation, turned_by(shortened(turn, most), begun[k]))

    def _error(self, poses: dict[int, tuple[Vector, Quaternion]], goals: Sequence[Goal]) -> Array:
        """What is missing, each goal's part no longer than two levers and a radian."""
        rows: list[float] = []
        for goal in goals:
            place, turned = poses[goal.link]
            if goal.position is not None:
                rows.extend(shortened(sub(goal.position, place), 2.0 * self.lever))
            if goal.orientation is not None:
                rows.extend(scaled(shortened(way(turned, goal.orientation), 1.0), self.lever))
        return np.array(rows)

    def _jacobian(
        self, posture: Posture, poses: dict[int, tuple[Vector, Quaternion]], goals: Sequence[Goal],
        free: dict[int, Axes], slack: dict[int, float],
    ) -> tuple[list[tuple[int, int]], Array]:
        """(joint, number of a hinge's angle or -1 for a ball's three columns), and all columns (rows, n): turns in the world,
        ways of slides in levers."""
        owners: list[tuple[int, int]] = []
        columns: list[list[float]] = []
        for k in self.joints:
            node, place = self.tree.nodes[k], poses[k][0]
            axes: list[Vector] = []
            if node.is_ball:
                owners.append((k, -1))
                axes = [*free[k]]
            else:
                turned = self.tree.above(k, poses)
                for h, hinge in enumerate(node.hinges, start=node.first_angle):
                    owners.append((k, h))
                    axes.append(scaled(rotate(turned, hinge.axis), slack[h]))
                    if not node.is_slide:
                        turned = multiply(turned, exp(scaled(hinge.axis, posture.angles[h])))
            for axis in axes:
                column: list[float] = []
                for goal, chain in zip(goals, self.chains, strict=True):
                    reaches = k in chain
                    if goal.position is not None:
                        moved = scaled(axis, self.lever) if node.is_slide else cross(axis, sub(poses[goal.link][0], place))
                        column.extend(moved if reaches else ZERO)
                    if goal.orientation is not None:
                        column.extend(scaled(axis, self.lever) if reaches and not node.is_slide else ZERO)
                columns.append(column)
        return owners, np.array(columns).T

    def _apply(
        self, posture: Posture, poses: dict[int, tuple[Vector, Quaternion]], owners: Sequence[tuple[int, int]],
        step: list[float], free: dict[int, Axes], slack: dict[int, float],
    ) -> float:
        """Turn the joints, project each into its limits, and update what is free; the most [rad, levers]
        that one of them has turned or slid."""
        at, most = 0, 0.0
        for k, h in owners:
            node = self.tree.nodes[k]
            if h >= 0:
                unit = self.lever if node.is_slide else 1.0
                asked = slack[h] * step[at] * unit
                hinge, wanted = node.hinges[h - node.first_angle], posture.angles[h] + asked
                before, posture.angles[h] = posture.angles[h], min(max(wanted, hinge.lower), hinge.upper)
                most = max(most, abs(posture.angles[h] - before) / unit)
                slack[h] *= 1.0 - _stopped(abs(posture.angles[h] - wanted), abs(asked))
                at += 1
                continue
            turn = ZERO
            for axis, share in zip(free[k], step[at : at + 3], strict=True):
                turn = add(turn, scaled(axis, share))
            at += 3
            above = self.tree.above(k, poses)
            wanted_turn = normalised(multiply(exp(rotate(conjugate(above), turn)), posture.turns[k]))
            was, posture.turns[k] = posture.turns[k], allowed(node.limits, node.orientation, wanted_turn)
            most = max(most, norm(way(was, posture.turns[k])))
            lost = way(posture.turns[k], wanted_turn)
            free[k] = _stiffened(free[k], rotate(above, lost), _stopped(norm(lost), norm(turn)))
        return most


def turn_about(
    tree: Tree, posture: Posture, k: int, axis: Vector, angle: float, poses: dict[int, tuple[Vector, Quaternion]]
) -> float:
    """Turn the joint of a link about an axis in the world, by the hinge that is nearest to it if it has hinges; the angle [rad]
    that its limits leave of it."""
    node, above = tree.nodes[k], tree.above(k, poses)
    if node.is_ball:
        turn = turned_by(rotate(conjugate(above), scaled(axis, angle)), posture.turns[k])
        was, posture.turns[k] = posture.turns[k], allowed(node.limits, node.orientation, turn)
        return norm(way(was, posture.turns[k]))
    along = [] if node.is_slide else [dot(rotate(above, hinge.axis), axis) for hinge in node.hinges]
    best = max(range(len(along)), key=lambda h: abs(along[h]), default=-1)
    if best < 0:
        return 0.0
    hinge, at = node.hinges[best], node.first_angle + best
    wanted = posture.angles[at] + (angle if along[best] > 0.0 else -angle)
    before, posture.angles[at] = posture.angles[at], min(max(wanted, hinge.lower), hinge.upper)
    return abs(posture.angles[at] - before)


def exterior_angle(a: float, b: float, distance: float) -> float:
    """[rad] by which two bones of lengths a and b [m] are bent when their ends are so far apart: 0 straight, pi folded."""
    if not a * b > 0.0:
        return 0.0
    cosine = min(max((distance * distance - a * a - b * b) / (2.0 * a * b), -1.0), 1.0)
    return atan2(sqrt(1.0 - cosine * cosine), cosine)


def _largest(owners: Sequence[tuple[int, int]], step: list[float]) -> float:
    """The most [rad] that a joint turns in a step."""
    at, most = 0, 0.0
    for _, h in owners:
        turned = abs(step[at]) if h >= 0 else hypot(*step[at : at + 3])
        at, most = at + (1 if h >= 0 else 3), max(most, turned)
    return most


def allowed(limits: Limits | None, orientation: Quaternion, turn: Quaternion) -> Quaternion:
    """The turn of a ball against its rest orientation, inside its limits."""
    if limits is None:
        return turn
    full = multiply(orientation, turn)
    found = inside(limits, full)
    return turn if found is full else normalised(multiply(conjugate(orientation), found))


def _stopped(lost: float, asked: float) -> float:
    """Share, 0 to 1, to which a joint is stopped whose limits took `lost` of the turn `asked` [rad]; continuous in both."""
    return min(lost / max(STOPPED * asked, INWARD), 1.0)


def _stiffened(free: Axes, direction: Vector, share: float) -> Axes:
    """Add a cost of turns along `direction` to what a ball is free to do, a symmetric matrix (rank-one update of its inverse)."""
    length = norm(direction)
    if not length > 0.0:
        return free
    along = scaled(direction, 1.0 / length)
    x, y, z = taken = dot(free[0], along), dot(free[1], along), dot(free[2], along)
    factor = share / (1.0 - share * (1.0 - LEAST_FREE - dot(taken, along)))
    a, b, c = free
    return sub(a, scaled(taken, factor * x)), sub(b, scaled(taken, factor * y)), sub(c, scaled(taken, factor * z))
