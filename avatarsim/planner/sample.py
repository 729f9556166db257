"""Samples of RRT-Connect: postures drawn from a seeded generator, places in the room and joints near a node in turn.

A doorway is found by the root, in a posture that fits through it; a limb that is caught is freed by joints near where they are.
"""

from math import pi, sqrt

from avatarsim.ik.state import Avatars
from avatarsim.ik.target import clip_avatar, copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.planner.state import Ghost, Plan
from avatarsim.planner.tree import AIM, get_node, put_node
from avatarsim.spatial.random import MODULUS, MULTIPLIER
from avatarsim.spatial.tangent import columns, put_columns, stepped, turned_back
from avatarsim.spatial.vec3 import along, dot, norm, put_row, row, sub
from avatarsim.world.skeleton import BALL, FREE, HINGES, Skeleton

MARGIN = 4.0
"""[mean reaches of a link] how far beyond start and goal the first places are drawn, an arm's length, and half of their distance
more. The room around them grows with the root of the samples drawn."""

TURN, MOVE = 1.2, 3.0
"""[rad, mean reaches] how far at most joints and root of a local sample are from those of its node. Larger: they end in what
stands around; smaller: they stay in the trap."""


@kernel
def drawn(avatar: int, plan_out: Plan) -> float:
    """A random number from 0 to 1."""
    s = plan_out.searches
    s.random[avatar] = s.random[avatar] * MULTIPLIER % MODULUS
    return float(s.random[avatar] / MODULUS)


@kernel
def draw_sample(skel: Skeleton, avatars: Avatars, avatar: int, goal: int, plan_out: Plan, ghost_out: Ghost) -> None:
    """Draw the next sample into node AIM; node 0 is the start, `goal` the root of the other tree."""
    s, target, root = plan_out.searches, ghost_out.scratch.target, avatars.first_link[avatar]
    if skel.kind[root] == FREE and s.samples[avatar] % 2 == 0:
        place_sample(skel, avatars, avatar, goal, plan_out, ghost_out)
    else:
        k = int(drawn(avatar, plan_out) * s.count[avatar]) % s.count[avatar]
        get_node(skel, avatars, avatar, k, plan_out, target)
        disturb(skel, avatars, avatar, plan_out, ghost_out)
    s.samples[avatar] += 1
    clip_avatar(skel, avatars, avatar, target, ghost_out.state.tracking, target)
    put_node(skel, avatars, avatar, target, AIM, plan_out)


@kernel
def place_sample(skel: Skeleton, avatars: Avatars, avatar: int, goal: int, plan_out: Plan, ghost_out: Ghost) -> None:
    """A place in the room around start and goal, any heading, with the joints of the travel posture, the start's or the
    goal's."""
    target, root, up = ghost_out.scratch.target, avatars.first_link[avatar], (ghost_out.up[0], ghost_out.up[1], ghost_out.up[2])
    kind = int(4.0 * drawn(avatar, plan_out))
    get_node(skel, avatars, avatar, goal, plan_out, target)
    there = row(target.root, root)
    get_node(skel, avatars, avatar, 0, plan_out, target)
    here = row(target.root, root)
    if kind == 1:
        get_node(skel, avatars, avatar, goal, plan_out, target)
    elif kind >= 2:
        copy_posture(skel, avatars, avatar, ghost_out.travel, target)
    samples = plan_out.searches.samples[avatar]
    margin = MARGIN * ghost_out.state.tracking.reach[avatar] + 0.5 * norm(sub(there, here))
    margin *= sqrt(1.0 + samples)
    for i in range(3):
        low, high = min(here[i], there[i]) - margin, max(here[i], there[i]) + margin
        target.root[root, i] = low + (high - low) * drawn(avatar, plan_out)
    # an avatar with joints stands on floors: up and down only as far as start and goal are; a hand goes over things
    is_standing = dot(up, up) > 0.5 and avatars.first_dof[avatar + 1] > skel.first_dof[root + 1]
    height, one, other = dot(up, row(target.root, root)), dot(up, here), dot(up, there)
    wanted = min(one, other) + abs(one - other) * drawn(avatar, plan_out)
    put_row(target.root, root, along(row(target.root, root), wanted - height if is_standing else 0.0, up))
    heading = 2.0 * pi * (drawn(avatar, plan_out) - 0.5)
    frame = columns(target.turn, root)
    axis = turned_back(frame, up)
    put_columns(target.turn, root, stepped(frame, (heading * axis[0], heading * axis[1], heading * axis[2])))


@kernel
def disturb(skel: Skeleton, avatars: Avatars, avatar: int, plan_out: Plan, ghost_out: Ghost) -> None:
    """Displace all degrees of freedom of the sample at random, by a share that is drawn once."""
    target, share = ghost_out.scratch.target, drawn(avatar, plan_out)
    turn, move = TURN * share, MOVE * share * ghost_out.state.tracking.reach[avatar]
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        kind = skel.kind[link]
        if kind == FREE:
            for i in range(3):
                target.root[link, i] += move * (2.0 * drawn(avatar, plan_out) - 1.0)
        if kind == FREE or kind == BALL:
            x = turn * (2.0 * drawn(avatar, plan_out) - 1.0)
            y = turn * (2.0 * drawn(avatar, plan_out) - 1.0)
            z = turn * (2.0 * drawn(avatar, plan_out) - 1.0)
            put_columns(target.turn, link, stepped(columns(target.turn, link), (x, y, z)))
        elif kind == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                target.angle[j] += turn * (2.0 * drawn(avatar, plan_out) - 1.0)
