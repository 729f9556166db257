"""State of the planner: the search of each avatar from frame to frame, and the planning avatar, unseen, that takes its steps.

A search lasts many frames, in slices of work, so all of it is kept: trees, random generator, the extension it is in. The planning
avatar is working memory: as a slice begins it is placed at a node, among everything else as it is shown, with nothing remembered.

The arrays of the planner, made once per scene.
"""

from enum import IntEnum
from typing import Annotated, Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.make import empty_posture, indices, make_state, make_working, zeros
from avatarsim.ik.state import Avatars, IkScratch, IkState
from avatarsim.jit.kept import AVATAR, COUNT, FLAG, Whole
from avatarsim.jit.layout import Cube, IndexGrid, IndexLine, Line
from avatarsim.jit.record import known_as_table
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.model.skeleton import BALL, FREE, Posture, Skeleton
from avatarsim.spatial.random import MODULUS, seeded

Array = NDArray[np.float64]
Index = NDArray[np.int64]

NODES = 512
"""Most nodes of a search, of both trees and of its shortcuts, per avatar. A node is a posture: 1.2 kB of a human of 16 balls.
Half of them: searches in rooms with a door end for want of nodes."""

NONE = -1

GOAL_NODE = 1
"""Node 0 is the root of the tree from the shown posture, this one of that from the goal."""


class Outcome(IntEnum):
    """Result of a slice of a search."""

    SEARCHING = 0
    """Its work is spent; it continues in the next frame."""
    FOUND = 1
    """There is a path, and waiting has cost as much as it does."""
    FAILED = 2
    """Samples or nodes are used up."""
    NO_GOAL = 3
    """No posture near the target's is free and near enough."""
    STALE = 4
    """Where the search or its path ends is no goal any more: the target, or the avatar, has moved on."""


class Phase(IntEnum):
    """Next activity of a search."""

    GOAL = 0
    """Look for a free posture near the target's."""
    SAMPLE = 1
    """Draw a sample, and choose the node that is extended towards it."""
    EXTEND = 2
    """Extend one tree towards the sample."""
    CONNECT = 3
    """Extend the other tree towards where that ended."""
    CUT = 4
    """The path is found: choose a shortcut."""
    TRY_CUT = 5
    """Extend from one node of the path towards a later one."""
    TRY_END = 6
    """Extend from a node of the path that is followed towards the present target."""


SEARCH = np.dtype(
    [
        ("phase", "i8"), ("candidate", "i8"), ("samples", "i8"), ("tree", "i8"), ("count", "i8"), ("at", "i8"), ("begun", "i8"),
        ("meeting", "i8"), ("here", "i8"), ("value", "f8"), ("pace", "f8"), ("edge", "f8"), ("length", "i8"), ("lasts", "f8"),
        ("place", "i8"), ("late", "f8"), ("cuts", "i8"), ("cut_from", "i8"), ("cut_to", "i8"), ("spared", "f8"), ("rest", "f8"),
        ("pause", "f8"), ("paid", "f8"), ("random", "i8"),
    ],
    align=True,
)
"""One row of Searches."""


NODE: Final = Whole(0, NODES - 1)
NODE_OR_NONE: Final = Whole(NONE, NODES - 1)
NODE_COUNT: Final = Whole(0, NODES)


class Searches(np.recarray[Any, np.dtype[Any]]):
    """One row per avatar."""

    phase: Annotated[Index, Whole(min(Phase), max(Phase))]
    """A Phase."""
    candidate: Annotated[Index, NODE_COUNT]
    """Number of the next posture near the target's that is tested for being free."""
    samples: Annotated[Index, NODE_COUNT]
    """Samples drawn in this search."""
    tree: Annotated[Index, FLAG]
    """The tree that is extended: 0 from the shown posture, 1 from the goal."""
    count: Annotated[Index, NODE_COUNT]
    """Nodes in use."""
    at: Annotated[Index, NODE_OR_NONE]
    """Node that the extension has come to."""
    begun: Annotated[Index, NODE_COUNT]
    """Nodes in use as the extension began."""
    meeting: Annotated[Index, NODE_OR_NONE]
    """Node of the other tree that a connection goes to."""
    here: Annotated[Index, NODE]
    """Node of tree 0 near which the avatar is shown now: while a path is searched it continues tracking."""
    value: Array
    """[m^2] objective towards the end of the extension after its last step."""
    pace: Array
    """[strides] how long its next step may be."""
    edge: Array
    """[strides] how long the edge is that its steps are put into."""
    length: Annotated[Index, NODE_COUNT]
    """Nodes of the path."""
    lasts: Array
    """[s] that the path took before the last slice; 0 until that is known."""
    place: Annotated[Index, NODE]
    """Place in the path of the node that is the target now."""
    late: Array
    """[s] by which the avatar is late at the node that it goes to: since it set out, less the time of the catch-up speeds."""
    cuts: Annotated[Index, COUNT]
    """Shortcuts tried."""
    cut_from: Annotated[Index, NODE]
    """Place in the path from which a shortcut is tried."""
    cut_to: Annotated[Index, NODE]
    """Place in the path to which it is tried."""
    spared: Array
    """[s] that the path takes between these two."""
    rest: Array
    """[s] until a waiting avatar searches again."""
    pause: Array
    """[s] that it rests after the next search in vain."""
    paid: Array
    """[m^2 s] cost of waiting: the objective, summed since it has stopped falling."""
    random: Annotated[Index, Whole(1, MODULUS - 1)]
    """State of the generator (Park and Miller 1988)."""


known_as_table(Searches, SEARCH)


class Plan(NamedTuple):
    """State of the searches that stays from frame to frame.

    searches  a row per avatar
    node      (na, NODES + 1, w) postures of the nodes, the last of them the end of the extension. One is packed link by link in
              the scene's order, without gaps: of a free root its position (3) [m] and its rotation matrix (9) row by row, of a
              ball its rotation matrix (9), of hinges and slides their coordinates [rad, m]; the part of w that an avatar does
              not need is not read
    before    (na, NODES) the node that each was reached from, -1 at a root
    tree      (na, NODES) of each node: 0 from the shown posture, 1 from the goal, 2 of shortcuts
    path      (na, NODES) nodes from the shown posture to the goal
    turn      (1) the avatar whose search has the first slice
    """

    searches: Searches
    node: Cube
    before: Annotated[IndexGrid, NODE_OR_NONE]
    tree: Annotated[IndexGrid, Whole(0, 2)]
    path: Annotated[IndexGrid, NODE_OR_NONE]
    turn: Annotated[IndexLine, AVATAR]


class PlanningAvatar(NamedTuple):
    """The unseen avatar: posture, poses, state and working memory of its steps; aim: the posture that it goes to. travel: the
    posture that avatars began with, in which they are led through rooms; up (3): against gravity, zero without."""

    posture: Posture
    poses: Poses
    state: IkState
    scratch: IkScratch
    aim: Posture
    travel: Posture
    up: Line


def packed_width(skel: Skeleton, avatars: Avatars) -> int:
    """Return the numbers that the packed posture of any avatar takes."""
    widths = [0]
    for a in range(len(avatars.first_link) - 1):
        kinds = skel.kind[avatars.first_link[a] : avatars.first_link[a + 1]]
        hinges = avatars.first_dof[a + 1] - avatars.first_dof[a] - 6 * (kinds == FREE).sum() - 3 * (kinds == BALL).sum()
        widths.append(int(12 * (kinds == FREE).sum() + 9 * (kinds == BALL).sum() + hinges))
    return max(widths)


def plan_is_sound(plan: Plan) -> bool:
    """Return True if every node that a plan from bytes names exists, and its trees have no circles."""
    s, numbers = plan.searches, np.arange(NODES)
    used, length = s["count"], s["length"]
    last = np.maximum(used - 1, 0)
    if (plan.before >= numbers).any():
        return False
    for at in (s["at"], s["meeting"], s["here"]):
        if (at > last).any():
            return False
    in_path = numbers < length[:, None]
    if (plan.path[in_path] > np.broadcast_to(last[:, None], plan.path.shape)[in_path]).any():
        return False
    places = (s["place"], s["cut_from"], s["cut_to"])
    return bool((s["begun"] <= used).all()) and all((place < np.maximum(length, 1)).all() for place in places)


def make_planner(
    geo: Geometry, skel: Skeleton, avatars: Avatars, shown: IkState, posture: Posture, poses: Poses, gravity: Array, seed: int
) -> tuple[Plan, PlanningAvatar]:
    """Return a planner of avatars at `posture`, in which they travel."""
    na, nl, nd = len(avatars.first_link) - 1, len(skel.kind), int(skel.first_dof[-1])
    searches = np.zeros(na, SEARCH).view(Searches)
    for a in range(na):
        # of the same seed each avatar draws its own
        searches["random"][a] = seeded((seed + 7919 * a) % MODULUS)[0]
    before, path = np.full((na, NODES), NONE, dtype=np.int64), indices(na, NODES)
    plan = Plan(searches, zeros(na, NODES + 1, packed_width(skel, avatars)), before, indices(na, NODES), path, indices(1))
    strength = float(np.linalg.norm(gravity))
    up = -gravity / strength if strength > 0.0 else zeros(3)
    planning_avatar = PlanningAvatar(
        empty_posture(nl, nd), Poses(*(array.copy() for array in poses)),
        make_state(geo, skel, avatars, shown.tracking["reach"].copy(), zeros(nd, 3), posture),
        make_working(geo, skel, avatars, poses, 0), empty_posture(nl, nd), Posture(*(array.copy() for array in posture)), up,
    )
    return plan, planning_avatar
