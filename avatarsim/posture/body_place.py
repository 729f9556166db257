"""Where the body goes of a user whose joints are far beyond their limits: to where its links' origins are nearest to the user's.

Each joint then goes its own way, and a limb that its limits stop ends far from the user's. With the body held where
the tracker's is, all of that shows as distance; the same posture shifted and turned as one rigid body is a fifth nearer. What is
nearest changes from frame to frame, so the body goes there no faster than a cap, and comes back as fast.
"""

from avatarsim.kernel import kernel
from avatarsim.posture.closeness import locate
from avatarsim.posture.workspace import ASTRAY, BEYOND, Goal
from avatarsim.spatial.symmetric import solved
from avatarsim.spatial.tangent import columns, product, put_columns, rotation_vector, stepped, straightened, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, put_row, row, scale, sub
from avatarsim.world.skeleton import FREE, Skeleton

FAR_BEYOND, BACK = 0.85, 0.75
"""[rad] root mean square excess of the tracker's joints over their limits beyond which each goes its own way: what is nearest to
such a posture changes from frame to frame, and a body that sought it in all its joints shifted with it by 0.2 m; and that below
which this is over: with one number for both, a user who swings about it is followed now so and now so, and the body shifts."""

BODY = 5.0
"""What the turn of the body weighs, in units of what a joint's angle weighs in contact: it carries all of them. 1: as near, and
joints are a degree farther from the user's; 10: limbs a fiftieth farther."""

MOST_MOVED, MOST_TURNED = 0.03, 0.3
"""[m], [rad] what the body goes aside or comes back in a frame at most. Less: limbs that swing leave it behind; 0.05 m: a
fortieth nearer, and it shows."""


@kernel
def place_bodies(skel: Skeleton, goal_out: Goal) -> None:
    """Put the roots of goal.tracker, which `clip_to_limits` has put where the tracker's are, aside as far as they are to be.

    goal.aside keeps how far: its root [m] in the world's axes, its turn in those of the tracker's root.
    """
    g = goal_out
    mode = g.closeness.mode
    edge = BACK if mode[ASTRAY] > 0.0 else FAR_BEYOND
    astray = bool(mode[BEYOND] > edge * edge)
    mode[ASTRAY] = 1.0 if astray else 0.0
    if astray:
        for link in range(skel.kind.shape[0]):
            if skel.kind[link] == FREE:
                put_aside(link, g)
        locate(skel, g.tracker, g.closeness)
        for link in range(skel.kind.shape[0]):
            put_row(g.closeness.way, link, row(g.closeness.there, link))
        locate(skel, g.own, g.closeness)
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] != FREE or not (astray or is_aside(link, g)):
            continue
        if astray:
            go_nearer(skel, link, g)
        else:
            come_back(link, g)
        put_aside(link, g)


@kernel
def stay_aside(skel: Skeleton, goal_out: Goal) -> None:
    """Put the roots of goal.tracker aside as far as `place_bodies` did in this frame."""
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] == FREE and is_aside(link, goal_out):
            put_aside(link, goal_out)


@kernel
def is_aside(root: int, goal: Goal) -> bool:
    """Whether a body is to be elsewhere than the tracker's."""
    gone, turn = row(goal.aside.root, root), columns(goal.aside.turn, root)
    return bool(dot(gone, gone) > 0.0 or turn[0][0] < 1.0 or turn[1][1] < 1.0)


@kernel
def put_aside(root: int, goal_out: Goal) -> None:
    """Move a root of goal.tracker by goal.aside from where the tracker's own is."""
    g = goal_out
    put_row(g.tracker.root, root, add(row(g.own.root, root), row(g.aside.root, root)))
    put_columns(g.tracker.turn, root, product(columns(g.own.turn, root), columns(g.aside.turn, root)))


@kernel
def middle_of(root: int, goal: Goal) -> tuple[Vec3, Vec3]:
    """Mean of a body's link origins inside the limits, closeness.way, and of the ways from there to the tracker's own,
    closeness.there."""
    c, n, middle, way = goal.closeness, 0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for link in range(c.root.shape[0]):
        if c.root[link] == root:
            n += 1
            middle = add(middle, row(c.way, link))
            way = add(way, sub(row(c.there, link), row(c.way, link)))
    return scale(middle, 1.0 / n), scale(way, 1.0 / n)


@kernel
def turn_to(skel: Skeleton, root: int, middle: Vec3, goal: Goal) -> Vec3:
    """Turn [rad] (world's axes) about the middle of a body by which its origins come nearest: one step of Gauss and Newton of the
    squared distances and of the weighed angle to the tracker's root."""
    c = goal.closeness
    weight = BODY * c.turn_weight[skel.first_dof[root] + 3]
    back = turned(columns(goal.own.turn, root), rotation_vector(columns(goal.aside.turn, root)))
    twist = scale(back, -weight)
    x, y, z = (weight, 0.0, 0.0), (0.0, weight, 0.0), (0.0, 0.0, weight)
    for link in range(c.root.shape[0]):
        if c.root[link] == root:
            arm = sub(row(c.way, link), middle)
            square = dot(arm, arm)
            twist = add(twist, cross(arm, sub(row(c.there, link), row(c.way, link))))
            x = along(add(x, (square, 0.0, 0.0)), -arm[0], arm)
            y = along(add(y, (0.0, square, 0.0)), -arm[1], arm)
            z = along(add(z, (0.0, 0.0, square)), -arm[2], arm)
    return solved(x, y, z, twist)


@kernel
def go_nearer(skel: Skeleton, root: int, goal_out: Goal) -> None:
    """Bring a body as near to the tracker's own as a frame may: its middle to the tracker's, turned by `turn_to`."""
    g = goal_out
    middle, way = middle_of(root, g)
    turn = turn_to(skel, root, middle, g)
    move = add(way, cross(turn, sub(row(g.tracker.root, root), middle)))
    put_row(g.aside.root, root, add(row(g.aside.root, root), shortened(move, MOST_MOVED)))
    turn = turned_back(columns(g.tracker.turn, root), shortened(turn, MOST_TURNED))
    put_columns(g.aside.turn, root, straightened(stepped(columns(g.aside.turn, root), turn)))


@kernel
def come_back(root: int, goal_out: Goal) -> None:
    """Bring what a body is aside as near to nothing as a frame may."""
    a = goal_out.aside
    gone, turn = row(a.root, root), columns(a.turn, root)
    put_row(a.root, root, sub(gone, shortened(gone, MOST_MOVED)))
    left = rotation_vector(turn)
    if norm(left) <= MOST_TURNED:
        # to the bit: what rounding leaves would keep it aside for good
        put_columns(a.turn, root, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    else:
        put_columns(a.turn, root, straightened(stepped(turn, scale(shortened(left, MOST_TURNED), -1.0))))


@kernel
def shortened(v: Vec3, most: float) -> Vec3:
    """v, or what is `most` long of it."""
    long = norm(v)
    return v if long <= most else scale(v, most / long)
