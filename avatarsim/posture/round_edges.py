"""Where a link is drawn to that hangs before an obstacle whose edge is near: past that edge, and from there to the user's.

A foot that the user swings through a door frame slides on the wall's face to where it is nearest, and would hang there, since the
way past the frame leads away from the user's foot first. It is drawn aside, ever farther while it hangs, until it is past.
"""

from math import sqrt

from avatarsim.kernel import kernel
from avatarsim.posture.jointed import has_joints
from avatarsim.posture.workspace import FRAME, LISTED, NEARBY, SEEN, Memory
from avatarsim.spatial.vec3 import Rows as Boxes
from avatarsim.spatial.vec3 import Vec3, dot, row, sub
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Skeleton

HANGS = 0.1
"""Share of `far` (four mean reaches of a link) that an origin is from the user's at least, 0.1 m for a human; one that is farther
away than `far` is elsewhere, and not drawn round anything."""

WORTH = 0.7
"""Share of its distance from the user's origin at which a link may end beside the edge at most. 1: limbs go round what ends no
nearer."""

MORE, LESS = 0.03, 0.05
"""Shares of `far` by which the pull aside grows, or falls, in a frame. Less: a leg is past the frame when the user has left it;
0.05: the body that carries the leg jumps by 30 mm."""


@kernel
def side_apart(boxes: Boxes, a: int, b: int) -> int:
    """The one axis along which two boxes are apart; -1 if there is none, or more than one."""
    found = -1
    for k in range(3):
        if boxes[a, k] >= boxes[b, 3 + k] or boxes[a, 3 + k] <= boxes[b, k]:
            if found >= 0:
                return -1
            found = k
    return found


@kernel
def nearest_edge(boxes: Boxes, a: int, b: int, here: Vec3, there: Vec3, far: float) -> tuple[int, float]:
    """Past which edge of box b a link in box a ends nearest to the user's: axis, and where its origin is along it when the boxes
    are apart there; -1 if none is worth it. Its origin is `here`, the user's is `there`, `far` [m] away."""
    apart, least, axis, place = side_apart(boxes, a, b), WORTH * far, -1, 0.0
    for k in range(3):
        if apart < 0 or k == apart:
            continue
        for side in range(2):
            past = here[k] + (boxes[b, 3 + k] - boxes[a, k] if side == 1 else boxes[b, k] - boxes[a, 3 + k])
            sign = 1.0 if side == 1 else -1.0
            ahead, left = sign * (past - here[k]), sign * (past - there[k])
            # who is past it at the user's needs no pull
            if ahead < far and 0.0 < left < least:
                least, axis, place = left, k, past
    return axis, place


@kernel
def is_taken(boxes: Boxes, own: int, place: Vec3, memory: Memory) -> bool:
    """Whether a place lies in the box around another near body."""
    for n in range(memory.pairs.marks[NEARBY]):
        other, inside = memory.pairs.near[n], True
        for k in range(3):
            inside = inside and boxes[other, k] <= place[k] <= boxes[other, 3 + k]
        if inside and other != own:
            return True
    return False


@kernel
def wish_aside(geo: Geometry, skel: Skeleton, poses: Poses, memory_out: Memory) -> None:
    """How far [m] each link is to be drawn aside at last, into closeness.way: as far beyond the edge as the user's is away.

    Who has no joints lies on what they are pushed through (`around` of the settings).
    """
    c, pairs = memory_out.goal.closeness, memory_out.pairs
    least, most = (HANGS * c.far[0]) ** 2, c.far[0] ** 2
    c.way[:] = 0.0
    for n in range(pairs.marks[LISTED] if has_joints(skel) else 0):
        body, other = geo.body[pairs.listed[n, 0]], geo.body[pairs.listed[n, 1]]
        if other >= skel.first:
            continue
        link = body - skel.first
        here, there = row(c.here, link), row(c.there, link)
        way = sub(there, here)
        far = dot(way, way)
        if not (least < far < most):
            continue
        far = sqrt(far)
        axis, past = nearest_edge(poses.hulls, body, other, here, there, far)
        if axis < 0:
            continue
        target = (past if axis == 0 else there[0], past if axis == 1 else there[1], past if axis == 2 else there[2])
        if not is_taken(poses.hulls, other, target, memory_out):
            c.way[link, axis] = past - there[axis] + (far if past > here[axis] else -far)


@kernel
def round_edges(geo: Geometry, skel: Skeleton, poses: Poses, memory_out: Memory) -> None:
    """Put the origins that links are drawn to, closeness.there, aside as far as they are to be in this frame.

    Who is asked a second time in it goes no farther aside."""
    c, frame = memory_out.goal.closeness, memory_out.flags[FRAME]
    if frame == c.mode[SEEN]:
        for link in range(c.way.shape[0]):
            for k in range(3):
                c.there[link, k] += c.around[link, k]
        return
    wish_aside(geo, skel, poses, memory_out)
    begins = frame != c.mode[SEEN] + 1.0
    c.mode[SEEN] = frame
    for link in range(c.way.shape[0]):
        for k in range(3):
            now, wish = 0.0 if begins else c.around[link, k], c.way[link, k]
            most = (MORE if abs(wish) > abs(now) else LESS) * c.far[0]
            now += min(max(wish - now, -most), most)
            c.around[link, k] = now
            c.there[link, k] += now
