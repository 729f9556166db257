"""Trees of postures: nodes packed one after the other, nearest node by linear search.

A linear search beats any tree of cells below some thousand nodes, and adds no state. The distance is that of the objective:
metres of link origins and slides, and radians as the mean reach of a link.

Samples of RRT-Connect: postures drawn from a seeded generator, places in the room and joints near a node in turn.

A doorway is found by the root, in a posture that fits through it; a limb that is caught is freed by joints near where they are.
"""

from math import inf, pi, sqrt

from avatarsim.ik.state import Rig
from avatarsim.ik.target import clip_avatar, copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.model.skeleton import BALL, FREE, SLIDE, Posture, has_angles
from avatarsim.planner.state import NODES, NONE, Plan, PlanningAvatar
from avatarsim.spatial.random import MODULUS, MULTIPLIER
from avatarsim.spatial.tangent import columns, put_columns, stepped, turned_back
from avatarsim.spatial.vec3 import along, dot, norm, put_row, row, sub

MARGIN = 4.0
"""[mean reaches of a link] how far beyond start and goal the first places are drawn, an arm's length, and half of their distance
more. The room around them grows with the root of the samples drawn."""

TURN, MOVE = 1.2, 3.0
"""[rad, mean reaches] how far at most joints, and root and slides, of a local sample are from those of its node. Larger: they end
in obstacles; smaller: they stay in the trap."""


@kernel
def drawn(avatar: int, plan_out: Plan) -> float:
    """Return a random number from 0 to 1."""
    s = plan_out.searches
    s.random[avatar] = s.random[avatar] * MULTIPLIER % MODULUS
    return float(s.random[avatar] / MODULUS)


@kernel
def draw_sample(rig: Rig, avatar: int, goal: int, plan_out: Plan, planning_out: PlanningAvatar) -> None:
    """Draw the next sample into node AIM; node 0 is the start, `goal` the root of the other tree."""
    s, target, root = plan_out.searches, planning_out.scratch.target, rig.avatars.first_link[avatar]
    if rig.skel.kind[root] == FREE and s.samples[avatar] % 2 == 0:
        place_sample(rig, avatar, goal, plan_out, planning_out)
    else:
        k = int(drawn(avatar, plan_out) * s.count[avatar]) % s.count[avatar]
        get_node(rig, avatar, k, plan_out, target)
        disturb(rig, avatar, plan_out, planning_out)
    s.samples[avatar] += 1
    clip_avatar(rig, avatar, target, planning_out.state.tracking, target)
    put_node(rig, avatar, target, AIM, plan_out)


@kernel
def place_sample(rig: Rig, avatar: int, goal: int, plan_out: Plan, planning_out: PlanningAvatar) -> None:
    """Draw a place in the room around start and goal, any heading, with the joints of the travel posture, start or goal."""
    avatars = rig.avatars
    target, root = planning_out.scratch.target, avatars.first_link[avatar]
    up = planning_out.up[0], planning_out.up[1], planning_out.up[2]
    kind = int(4.0 * drawn(avatar, plan_out))
    get_node(rig, avatar, goal, plan_out, target)
    there = row(target.root, root)
    get_node(rig, avatar, 0, plan_out, target)
    here = row(target.root, root)
    if kind == 1:
        get_node(rig, avatar, goal, plan_out, target)
    elif kind >= 2:
        copy_posture(rig, avatar, planning_out.travel, target)
    samples = plan_out.searches.samples[avatar]
    margin = MARGIN * planning_out.state.tracking.reach[avatar] + 0.5 * norm(sub(there, here))
    margin *= sqrt(1.0 + samples)
    for i in range(3):
        low, high = min(here[i], there[i]) - margin, max(here[i], there[i]) + margin
        target.root[root, i] = low + (high - low) * drawn(avatar, plan_out)
    # an avatar with joints stands on floors: up and down only as far as start and goal are; a hand goes over things
    is_standing = dot(up, up) > 0.5 and avatars.first_dof[avatar + 1] > rig.skel.first_dof[root + 1]
    height, one, other = dot(up, row(target.root, root)), dot(up, here), dot(up, there)
    wanted = min(one, other) + abs(one - other) * drawn(avatar, plan_out)
    put_row(target.root, root, along(row(target.root, root), wanted - height if is_standing else 0.0, up))
    heading = 2.0 * pi * (drawn(avatar, plan_out) - 0.5)
    frame = columns(target.turn, root)
    axis = turned_back(frame, up)
    put_columns(target.turn, root, stepped(frame, (heading * axis[0], heading * axis[1], heading * axis[2])))


@kernel
def disturb(rig: Rig, avatar: int, plan_out: Plan, planning_out: PlanningAvatar) -> None:
    """Displace all degrees of freedom of the sample at random, by a share that is drawn once."""
    skel, avatars = rig.skel, rig.avatars
    target, share = planning_out.scratch.target, drawn(avatar, plan_out)
    turn, move = TURN * share, MOVE * share * planning_out.state.tracking.reach[avatar]
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
        elif has_angles(skel, link):
            most = move if kind == SLIDE else turn
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                target.angle[j] += most * (2.0 * drawn(avatar, plan_out) - 1.0)


AIM = NODES
"""The node beyond all others: where the extension goes to."""


@kernel
def put_node(rig: Rig, avatar: int, posture: Posture, k: int, plan_out: Plan) -> None:
    """Write the posture of an avatar into its node k."""
    skel, avatars = rig.skel, rig.avatars
    node, at = plan_out.node, 0
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        kind = skel.kind[link]
        if kind == FREE:
            for i in range(3):
                node[avatar, k, at + i] = posture.root[link, i]
            at += 3
        if kind == FREE or kind == BALL:
            for i in range(3):
                for j in range(3):
                    node[avatar, k, at + 3 * i + j] = posture.turn[link, i, j]
            at += 9
        elif has_angles(skel, link):
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                node[avatar, k, at] = posture.angle[j]
                at += 1


@kernel
def get_node(rig: Rig, avatar: int, k: int, plan: Plan, posture_out: Posture) -> None:
    """Write the posture of an avatar at its node k, to the bit."""
    skel, avatars = rig.skel, rig.avatars
    node, at = plan.node, 0
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        kind = skel.kind[link]
        if kind == FREE:
            for i in range(3):
                posture_out.root[link, i] = node[avatar, k, at + i]
            at += 3
        if kind == FREE or kind == BALL:
            for i in range(3):
                for j in range(3):
                    posture_out.turn[link, i, j] = node[avatar, k, at + 3 * i + j]
            at += 9
        elif has_angles(skel, link):
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                posture_out.angle[j] = node[avatar, k, at]
                at += 1


@kernel
def add_node(rig: Rig, avatar: int, posture: Posture, before: int, tree: int, plan_out: Plan) -> int:
    """Add a node that was reached from node `before`; return its number, or -1 where there is no room."""
    k = plan_out.searches.count[avatar]
    if k >= NODES:
        return NONE
    put_node(rig, avatar, posture, k, plan_out)
    plan_out.before[avatar, k], plan_out.tree[avatar, k] = before, tree
    plan_out.searches.count[avatar] = k + 1
    return int(k)


@kernel
def square_distance(rig: Rig, avatar: int, k: int, m: int, plan: Plan) -> float:
    """Return the squared distance [m^2] of two nodes; of rotations the chord, 3 - trace."""
    skel, avatars = rig.skel, rig.avatars
    node, at, total = plan.node, 0, 0.0
    low, high = avatars.first_link[avatar], avatars.first_link[avatar + 1]
    for link in range(low, high):
        kind, d = skel.kind[link], skel.first_dof[link]
        if kind == FREE:
            for i in range(3):
                apart = node[avatar, k, at + i] - node[avatar, m, at + i]
                total += (high - low) * apart * apart
            at, d = at + 3, d + 3
        if kind == FREE or kind == BALL:
            trace = 0.0
            for i in range(9):
                trace += node[avatar, k, at + i] * node[avatar, m, at + i]
            total += avatars.turn_weight[d] * (3.0 - trace)
            at += 9
        elif has_angles(skel, link):
            for j in range(d, skel.first_dof[link + 1]):
                apart = node[avatar, k, at] - node[avatar, m, at]
                total += avatars.turn_weight[j] * apart * apart
                at += 1
    return total


@kernel
def nearest_node(rig: Rig, avatar: int, m: int, tree: int, plan: Plan) -> int:
    """Return the node of a tree that is nearest to node m."""
    least, found = inf, 0
    for k in range(plan.searches.count[avatar]):
        if plan.tree[avatar, k] == tree:
            distance = square_distance(rig, avatar, k, m, plan)
            if distance < least:
                least, found = distance, k
    return found


@kernel
def trace_path(avatar: int, here: int, from_start: int, from_goal: int, plan_out: Plan) -> None:
    """Write the nodes from that at which the avatar is to the root of tree 1 into the path: through tree 0 to the one of its
    nodes that meets one of tree 1."""
    before, path, length = plan_out.before, plan_out.path, 0
    # a node has a greater number than the one it was reached from: both go up until they meet
    k, down, steps = here, from_start, 0
    while k != down:
        if k > down:
            path[avatar, length] = k
            length += 1
            k = before[avatar, k]
        else:
            down = before[avatar, down]
            steps += 1
    length += steps + 1
    k = from_start
    for i in range(steps + 1):
        path[avatar, length - 1 - i] = k
        k = before[avatar, k]
    k = from_goal
    while k >= 0:
        path[avatar, length] = k
        length += 1
        k = before[avatar, k]
    plan_out.searches.length[avatar] = length


@kernel
def keep_path(avatar: int, plan_out: Plan) -> None:
    """Give up all nodes but those of the path from the present place on, and move them up: room for shortcuts."""
    s, path, node, number = plan_out.searches, plan_out.path, plan_out.node, plan_out.before
    place, count = s.place[avatar], 0
    for i in range(place, s.length[avatar]):
        path[avatar, i - place] = path[avatar, i]
    s.length[avatar] -= place
    s.place[avatar] = 0
    # trees are needed no more: their arrays hold which nodes stay, and their new numbers
    for k in range(s.count[avatar]):
        plan_out.tree[avatar, k] = 0
    for i in range(s.length[avatar]):
        plan_out.tree[avatar, path[avatar, i]] = 2
    for k in range(s.count[avatar]):
        if plan_out.tree[avatar, k] == 2:
            for i in range(node.shape[2]):
                node[avatar, count, i] = node[avatar, k, i]
            number[avatar, k] = count
            count += 1
    for i in range(s.length[avatar]):
        path[avatar, i] = number[avatar, path[avatar, i]]
    for k in range(s.count[avatar]):
        number[avatar, k] = NONE
    s.count[avatar], s.begun[avatar] = count, count
