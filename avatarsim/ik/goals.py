"""Postures for goals of links: damped least squares within joint limits.

Wampler 1986; Buss 2004; damped by the error, Sugihara 2011. Goals of several links are one stacked system. After a round each
joint is projected into its limits. Steps in the direction that its limits took away then cost more in later rounds, so that the
rest of the chain makes up for the joint (weighted least norm, Chan and Dubey 1995). The cost is a continuous function of the
share that was taken away: a projection that changes a turn by its rounding alone stops no joint.

No obstacles are known here, and free roots stay: the posture found is a target, which `ik/solve.py` follows.
"""

from collections.abc import Sequence
from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from avatarsim.ik.constraints import add_point_jacobian
from avatarsim.ik.kinematics import parts_of
from avatarsim.ik.make import empty_posture
from avatarsim.jit.kernel import entry_kernel, kernel
from avatarsim.jit.layout import FlagLine, Grid, IndexLine, Line, Matrices, Vectors
from avatarsim.model.geometry import Poses
from avatarsim.model.joint_limits import LEFT_ALONE, has_cone, inside_cone, surely_inside
from avatarsim.model.skeleton import BALL, FREE, SLIDE, Posture, Skeleton, carry, has_angles, translations
from avatarsim.spatial.tangent import Columns, columns, put_columns, step_between, stepped, straightened, turn_of
from avatarsim.spatial.vec3 import Vec3, add, dot, limited, norm, put_row, row, scale, sub
from avatarsim.tolerances import ROUGH

DAMPING = 1e-4
"""Least damping as a share of the squared lever. Less: a stretched limb turns about its own axis; more: slower near a goal."""

STALLED = 0.95
"""Share of the error before a round above which that round did not help: limits, or the length of the limb, stop it."""

SPENT = 1e-3
"""Share of the turn that joints may make in a call, below which nothing is left of it."""

STEEPEST = 0.6
"""[rad] largest turn of a joint in a round: the linear model of a turn is off by 6 % there."""

STOPPED = 0.25
"""Share of a turn from which on a joint whose limits take it away counts as stopped. Larger: joints at limits are moved again in
vain; smaller: more of a rounding error comes into the posture."""

LEAST_FREE = 1e-3
"""Share of its freedom that a stopped joint keeps, so that no system is singular."""

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Goals(NamedTuple):
    """Goals of n links: link (n); place (n, 3) of the joint's centre [m] and turn (n, 3, 3) of the link, in the world; has_place,
    has_turn (n) which of the two count."""

    link: IndexLine
    place: Vectors
    turn: Matrices
    has_place: FlagLine
    has_turn: FlagLine


class GoalScratch(NamedTuple):
    """Working memory for n goals and nd degrees of freedom.

    still (nd) zeros; poses and axes (nd, 3) of the posture; begun (nl, 3, 3) turns at the beginning of a call; error (6 n) [m];
    jacobian (6 n, nd); factor (6 n, 6 n); step (nd) [rad, m]
    mobility (nd, 3) how freely a degree moves: of a ball the rows of a symmetric matrix in the link's axes, of others the first
    number, in levers for slides; 0 for degrees that stay. The caller sets it before each call."""

    still: Line
    poses: Poses
    axes: Vectors
    begun: Matrices
    error: Line
    jacobian: Grid
    factor: Grid
    step: Line
    mobility: Vectors


def make_goals(n: int) -> Goals:
    """Return room for n goals, of which none counts yet."""
    none = np.zeros(n, dtype=np.bool_)
    return Goals(np.zeros(n, dtype=np.int64), np.zeros((n, 3)), np.zeros((n, 3, 3)), none, none.copy())


def make_goal_scratch(skel: Skeleton, n: int) -> GoalScratch:
    """Return working memory for n goals."""
    nl, nd = len(skel.kind), int(skel.first_dof[-1])
    poses = Poses(np.zeros((nl, 3)), np.zeros((nl, 3, 3)), np.zeros((0, 3)), np.zeros((0, 6)), np.zeros((0, 6)))
    return GoalScratch(
        np.zeros(nd), poses, np.zeros((nd, 3)), empty_posture(nl, nd).turn, np.zeros(6 * n), np.zeros((6 * n, nd)),
        np.zeros((6 * n, 6 * n)), np.zeros(nd), np.zeros((nd, 3)),
    )


def mobility(skel: Skeleton, links: Sequence[int], lever: float) -> Vectors:
    """Return the mobility (nd, 3) with which the joints of these links move freely and no others; free roots stay.

    `lever` [m] is the length that a turn of a radian counts as."""
    found = np.zeros((int(skel.first_dof[-1]), 3))
    for link in links:
        first, end = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == BALL:
            found[first:end] = np.eye(3)
        elif skel.kind[link] != FREE:
            found[first:end, 0] = lever if skel.kind[link] == SLIDE else 1.0
    return found


@entry_kernel
def approach(
    skel: Skeleton, goals: Goals, lever: float, close: float, rounds: int, most: float, damping: float, posture_out: Posture,
    scratch_out: GoalScratch,
) -> bool:
    """Move a posture within its limits towards goals, in at most so many rounds, no joint by more than `most` [rad, levers].

    Args:
        lever: length [m] that a turn of a radian counts as.
        close: error [m] below which the goals are reached, turns counted by the lever.
        damping: least damping, as `DAMPING`.

    Returns:
        Whether it came to a place from where further rounds would not help: the goals are out of reach.
    """
    s, left, before = scratch_out, most, inf
    for link in range(skel.kind.shape[0]):
        put_columns(s.begun, link, columns(posture_out.turn, link))
    for _ in range(rounds):
        carry(skel, posture_out, s.still, s.poses, s.axes)
        size = linearise(skel, goals, lever, s)
        if size < close:
            return False
        if size > STALLED * before:
            return True
        before = size
        find_step(skel, 0.5 * size * size + damping * lever * lever, s)
        shorten(skel, lever, min(left, STEEPEST), s)
        # motion that a limit takes away is not spent
        left -= take_within_limits(skel, lever, posture_out, s)
        if left <= SPENT * most:
            hold_back(skel, most, posture_out, s)
            return False
    return False


@kernel
def linearise(skel: Skeleton, goals: Goals, lever: float, scratch_out: GoalScratch) -> float:
    """Write the error at the present poses, each goal's part no longer than two levers and a radian, and its derivative by mobile
    degrees; return its length [m]."""
    s, square = scratch_out, 0.0
    s.error[:] = 0.0
    s.jacobian[:, :] = 0.0
    for g in range(goals.link.shape[0]):
        link, k = goals.link[g], 6 * g
        body = skel.first + link
        if goals.has_place[g]:
            offset = limited(sub(row(goals.place, g), row(s.poses.position, body)), 2.0 * lever)
            for i in range(3):
                s.error[k + i] = offset[i]
                add_point_jacobian(skel, body, 1.0, AXES[i], row(s.poses.position, body), s.poses, s.axes, k + i, s.jacobian)
        if goals.has_turn[g]:
            turn = limited(turn_of(columns(s.poses.rotation, body), columns(goals.turn, g)), 1.0)
            for i in range(3):
                s.error[k + 3 + i] = lever * turn[i]
                add_turn(skel, link, lever, i, s.axes, k + 3 + i, s.jacobian)
    for k in range(s.error.shape[0]):
        square += s.error[k] * s.error[k]
        move_freely(skel, s.mobility, s.jacobian[k])
    return sqrt(square)


@kernel
def add_turn(skel: Skeleton, link: int, lever: float, i: int, axes: Vectors, k: int, jacobian_out: Grid) -> None:
    """Add to row k how a link turns about axis i of the world, times a lever [m]."""
    while link >= 0:
        for j in range(skel.first_dof[link] + translations(skel, link), skel.first_dof[link + 1]):
            jacobian_out[k, j] += lever * axes[j, i]
        link = skel.parent[link]


@kernel
def move_freely(skel: Skeleton, mobility: Vectors, values_out: Line) -> None:
    """Multiply a row (nd) by the mobility."""
    for link in range(skel.kind.shape[0]):
        d, end = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == BALL:
            v = (values_out[d], values_out[d + 1], values_out[d + 2])
            for i in range(3):
                values_out[d + i] = dot(row(mobility, d + i), v)
        else:
            for j in range(d, end):
                values_out[j] *= mobility[j, 0]


@kernel
def find_step(skel: Skeleton, damping: float, scratch_out: GoalScratch) -> None:
    """Write the damped step J^T (J J^T + damping I)^-1 error, by Cholesky's factor; J is that of mobile degrees."""
    s, m = scratch_out, scratch_out.error.shape[0]
    factor, x = s.factor, s.error
    for i in range(m):
        for k in range(i + 1):
            total = damping if i == k else 0.0
            for j in range(s.step.shape[0]):
                total += s.jacobian[i, j] * s.jacobian[k, j]
            for j in range(k):
                total -= factor[i, j] * factor[k, j]
            factor[i, k] = sqrt(total) if i == k else total / factor[k, k]
        for k in range(i):
            x[i] -= factor[i, k] * x[k]
        x[i] /= factor[i, i]
    for i in range(m - 1, -1, -1):
        for k in range(i + 1, m):
            x[i] -= factor[k, i] * x[k]
        x[i] /= factor[i, i]
    for j in range(s.step.shape[0]):
        s.step[j] = 0.0
        for i in range(m):
            s.step[j] += s.jacobian[i, j] * x[i]
    move_freely(skel, s.mobility, s.step)


@kernel
def shorten(skel: Skeleton, lever: float, most: float, scratch_out: GoalScratch) -> None:
    """Shorten the step so that no joint turns by more than `most` [rad], or slides by more than that in levers."""
    step, largest = scratch_out.step, 0.0
    for link in range(skel.kind.shape[0]):
        slid, turned = parts_of(skel, link, step)
        largest = max(largest, max(slid / lever, turned))
    if largest > most:
        for j in range(step.shape[0]):
            step[j] *= most / largest


@kernel
def take_within_limits(skel: Skeleton, lever: float, posture_out: Posture, scratch_out: GoalScratch) -> float:
    """Move the posture by the step, project each joint into its limits, and lessen the mobility of those that were stopped.

    Returns:
        The most [rad, levers] that a joint has turned or slid."""
    s, most = scratch_out, 0.0
    for link in range(skel.kind.shape[0]):
        d, end = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == BALL:
            requested = (s.step[d], s.step[d + 1], s.step[d + 2])
            if norm(requested) > 0.0:
                before = columns(posture_out.turn, link)
                wanted = straightened(stepped(before, requested))
                now = allowed(skel, link, wanted)
                put_columns(posture_out.turn, link, now)
                most = max(most, norm(step_between(before, now)))
                lost = step_between(now, wanted)
                stiffen(s.mobility, d, lost, stopped(norm(lost), norm(requested)))
        elif has_angles(skel, link):
            for j in range(d, end):
                angle = posture_out.angle[j]
                now_at = min(max(angle + s.step[j], skel.limits[j, 0]), skel.limits[j, 1])
                posture_out.angle[j] = now_at
                most = max(most, abs(now_at - angle) / (lever if skel.kind[link] == SLIDE else 1.0))
                s.mobility[j, 0] *= 1.0 - stopped(abs(angle + s.step[j] - now_at), abs(s.step[j]))
    return most


@kernel
def allowed(skel: Skeleton, link: int, turn: Columns) -> Columns:
    """Return the turn of a ball, or the nearest one within its limits."""
    if not has_cone(skel.balls, link) or surely_inside(skel.balls, link, turn, LEFT_ALONE):
        return turn
    return inside_cone(skel.balls, link, turn)


@kernel
def stopped(lost: float, requested: float) -> float:
    """Return the share, 0 to 1, to which a joint is stopped if limits took `lost` of the turn `requested` [rad]; continuous in
    both."""
    return min(lost / max(STOPPED * requested, ROUGH), 1.0)


@kernel
def stiffen(mobility_out: Vectors, d: int, direction: Vec3, share: float) -> None:
    """Add a cost of turns along `direction` to the mobility of the ball at degree d: a rank-one update of its inverse."""
    length = norm(direction)
    if not length > 0.0:
        return
    along = scale(direction, 1.0 / length)
    response = (dot(row(mobility_out, d), along), dot(row(mobility_out, d + 1), along), dot(row(mobility_out, d + 2), along))
    factor = share / (1.0 - share * (1.0 - LEAST_FREE - dot(response, along)))
    for i in range(3):
        put_row(mobility_out, d + i, add(row(mobility_out, d + i), scale(response, -factor * response[i])))


@kernel
def hold_back(skel: Skeleton, most: float, posture_out: Posture, scratch: GoalScratch) -> None:
    """Undo turns of balls beyond `most` [rad] in a call, which a projection into limits may add."""
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] == BALL:
            begun = columns(scratch.begun, link)
            turn = step_between(begun, columns(posture_out.turn, link))
            if norm(turn) > most:
                put_columns(posture_out.turn, link, allowed(skel, link, stepped(begun, limited(turn, most))))
