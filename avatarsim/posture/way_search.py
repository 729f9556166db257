"""The search for a way out of a trap: an avatar that nobody sees tries detours under the same certificate.

Randomized descent. The first walk goes straight to the tracker's posture. Each later one begins at the shown posture or where
an earlier walk ended, goes to a random waypoint, and from there to the tracker's posture. A walk that arrives, or that ends with
the trunk much nearer to a tracker whose posture is not free, is a chain of certified postures. The shown avatar then follows it
(`way_lead.py`). Some of the work is done in each frame, counted and not timed, and waypoints come from the seed, so that results
repeat.
"""

from math import inf

from avatarsim.kernel import kernel
from avatarsim.posture.behind import hold, is_led
from avatarsim.posture.chain import draw
from avatarsim.posture.goal import aim, clip_to_limits, farthest, merit, root_way
from avatarsim.posture.held_off import CLOSER
from avatarsim.posture.kinematics import forward
from avatarsim.posture.notice import notice_others
from avatarsim.posture.step import work_done
from avatarsim.posture.untie import forget
from avatarsim.posture.walk import walk
from avatarsim.posture.way_memory import (
    CUT_FROM,
    CUT_TO,
    LEADING,
    LEAVES_USED,
    NODE,
    NODES_USED,
    OPEN,
    PHASE,
    RESTING,
    SEARCHING,
    TRIES,
    WALKED,
    Way,
    add_leaf,
    add_node,
    copy_poses,
    copy_posture,
    get_node,
)
from avatarsim.posture.way_path import choose_cut, splice, trace
from avatarsim.posture.workspace import FRAME, TRACKER_SPEED
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns, put_columns, stepped
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import BALL, FREE, HINGES, Posture, Skeleton

MOVES, TURNS, SMALL = 0.7, 1.2, 0.4
"""[m], [rad] how far at most a waypoint is from the posture it is made from, per degree of freedom, and the share of it in
every fourth try. Larger ones end in walls, smaller ones stay in the trap."""

PATIENCE, NEARER = 8, 0.8
"""Steps within which the merit of a walk to the tracker has to fall to this share of its least so far, or the walk ends."""

AWAY_STEPS, HOME_STEPS = 14, 12 * PATIENCE
"""Most steps to a waypoint, and from there to the tracker's posture, which end after each PATIENCE: so many nodes have to be left
when a walk begins. More wander, fewer do not get clear of what holds."""

STALLED, STILL = 0.02, 0.004
"""[rad or m] a shorter step on the way to the waypoint, or to the tracker, is the last one of that walk."""

ARRIVED, CLOSE = 0.05, 0.02
"""[rad or m] a walk so near to the tracker's posture in every joint has arrived; so near to a node, a short cut has."""

MOST_TRIES = 40
"""Walks before the search rests."""

TO_WAYPOINT, TO_TRACKER, TO_NODE = range(3)

FINE = 2000000
"""Number of values that a random share may have."""


@kernel
def share(way_out: Way) -> float:
    """A random number from -1 to 1."""
    return 2.0 * draw(way_out.random, FINE + 1) / FINE - 1.0


@kernel
def begin_tree(posture: Posture, poses: Poses, to_go: float, way_out: Way) -> None:
    """Begin a tree at the shown posture, among the bodies where they are now; its trunk is `to_go` [m] from the tracker's."""
    way_out.best[1] = to_go
    copy_poses(poses, way_out.poses)
    way_out.state[NODES_USED], way_out.state[LEAVES_USED] = 0, 0
    add_node(posture, -1, way_out)
    way_out.state[NODE] = -1


@kernel
def set_waypoint(skel: Skeleton, way_out: Way) -> None:
    """A random place and posture around the present one; in every second try around the tracker's posture, at this place."""
    s, tries = way_out, way_out.state[TRIES]
    scale = SMALL if tries % 4 == 3 else 1.0
    moves, turns = MOVES * scale, TURNS * scale
    base = s.goal if tries % 2 == 1 else s.posture
    copy_posture(s.posture, s.waypoint)
    for link in range(skel.kind.shape[0]):
        kind = skel.kind[link]
        if not is_led(skel, skel.first + link, s.memory.goal):
            continue
        if kind == FREE:
            for i in range(3):
                s.waypoint.root[link, i] = s.posture.root[link, i] + moves * share(s)
        if kind == FREE or kind == BALL:
            turn = (turns * share(s), turns * share(s), turns * share(s))
            put_columns(s.waypoint.turn, link, stepped(columns(base.turn, link), turn))
        elif kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                s.waypoint.angle[j] = base.angle[j] + turns * share(s)


@kernel
def place_unseen(geo: Geometry, skel: Skeleton, k: int, way_out: Way) -> None:
    """Put the unseen avatar at node k, with nothing remembered."""
    s = way_out
    get_node(s, k, s.posture)
    s.memory.rows.x[:] = 0.0
    forward(geo, skel, s.posture, s.memory.rows.x, s.poses, s.memory.axes)
    notice_others(geo, skel, s.poses, s.memory)
    s.state[NODE] = k


@kernel
def turn_to(phase: int, way_out: Way) -> None:
    """Begin a part of a walk, towards what the goal of the memory is."""
    s = way_out
    s.state[PHASE], s.state[WALKED] = phase, 0
    # a waypoint need not be reached, so on the way there limbs may circle
    s.memory.flags[TRACKER_SPEED] = 10.0 if phase == TO_WAYPOINT else 0.0
    s.best[0] = inf
    forget(s.memory)


@kernel
def choose_start(way_out: Way) -> int:
    """Node at which the next walk begins: the root, any leaf, or the one nearest to the tracker's posture."""
    s = way_out
    leaves = s.state[LEAVES_USED]
    if leaves == 0 or draw(s.random, 2) == 0:
        return 0
    leaf = draw(s.random, leaves)
    if draw(s.random, 2) == 0:
        for k in range(leaves):
            if s.leaf_merit[k] < s.leaf_merit[leaf]:
                leaf = k
    return int(s.leaves[leaf])


@kernel
def begin_walk(geo: Geometry, skel: Skeleton, way_out: Way) -> None:
    """Choose where the next walk begins and where it goes first; the first of all goes straight to the tracker."""
    s = way_out
    if s.state[NODES_USED] + AWAY_STEPS + HOME_STEPS > s.before.shape[0]:
        s.state[NODES_USED], s.state[LEAVES_USED] = 1, 0
    place_unseen(geo, skel, choose_start(s), s)
    if s.state[TRIES] == 0:
        clip_to_limits(skel, s.goal, s.memory.goal)
        turn_to(TO_TRACKER, s)
    else:
        set_waypoint(skel, s)
        clip_to_limits(skel, s.waypoint, s.memory.goal)
        turn_to(TO_WAYPOINT, s)
    s.state[TRIES] += 1


@kernel
def begin_cut(geo: Geometry, skel: Skeleton, way_out: Way) -> bool:
    """Begin to walk from one node of the path straight to a later one, if there is one more to try."""
    s = way_out
    if not choose_cut(s):
        return False
    place_unseen(geo, skel, s.path[s.state[CUT_FROM]], s)
    get_node(s, s.path[s.state[CUT_TO]], s.memory.goal.tracker)
    turn_to(TO_NODE, s)
    return True


@kernel
def judge_walk(geo: Geometry, skel: Skeleton, largest: float, way_out: Way) -> bool:
    """What follows from a step whose largest part was `largest`; True if the path is ready to be followed."""
    s = way_out
    walked, error, now = s.state[WALKED], farthest(s.memory.goal), merit(s.memory.goal)
    if s.state[PHASE] == TO_WAYPOINT:
        if walked >= AWAY_STEPS or error < ARRIVED or largest < STALLED:
            clip_to_limits(skel, s.goal, s.memory.goal)
            turn_to(TO_TRACKER, s)
    elif s.state[PHASE] == TO_NODE:
        if error < CLOSE:
            splice(s)
        if error < CLOSE or 2 * walked >= s.state[CUT_TO] - s.state[CUT_FROM]:
            return not begin_cut(geo, skel, s)
    elif error < ARRIVED:
        trace(s)
        return not begin_cut(geo, skel, s)
    elif walked % PATIENCE == 0 or largest < STILL:
        if walked >= HOME_STEPS or largest < STILL or now > NEARER * s.best[0]:
            if s.state[OPEN] == 0 and root_way(skel, s.memory.goal.full) < CLOSER * s.best[1]:
                trace(s)
                return not begin_cut(geo, skel, s)
            add_leaf(now, s)
            s.state[NODE] = -1
        s.best[0] = min(s.best[0], now)
    return False


@kernel
def search(geo: Geometry, skel: Skeleton, settings: PostureSettings, way_out: Way) -> int:
    """Walk until a way is found, or the work of this frame is done, or it is time to rest; return the mode to go on with."""
    s, work = way_out, 0
    while work < settings.search_work:
        if s.state[NODE] < 0:
            if s.state[TRIES] >= MOST_TRIES:
                return RESTING
            begin_walk(geo, skel, s)
        s.memory.counts[:] = 0
        s.memory.flags[FRAME] += 1.0
        hold(skel, False, s.memory.goal, s.memory.goal.allowed)
        largest = walk(geo, skel, settings, min(1, settings.steps), s.posture, s.poses, s.memory)
        s.state[WALKED] += 1
        add_node(s.posture, s.state[NODE], s)
        work += work_done(s.memory)
        aim(skel, s.posture, settings, s.memory.goal)
        if judge_walk(geo, skel, largest, s):
            return LEADING
    return SEARCHING
