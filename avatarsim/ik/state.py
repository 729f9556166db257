"""State of the posture solver: the arrays that stay from frame to frame, and the working memory of one frame.

All arrays are made once per scene, so that kernels allocate nothing. The links of an avatar, and its degrees of freedom, are
contiguous: avatar a has links first_link[a] .. first_link[a + 1] and degrees first_dof[a] .. first_dof[a + 1].

Warm start of pairs: a hash table with open addressing of the data of pairs of pieces (Knuth 1973, section 6.4).

Separating directions hardly change from step to step. The one that last held proves most pairs apart with two supports.

Bounds check of a posture solver's state that comes from bytes: may every place that it names be read and written?

Kernels do not check numbers that they themselves wrote. Here conditions between numbers are checked, once; those of a single
number are in the ranges of `lower_loop`.
"""

from enum import IntEnum
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.scratch import Scratch
from avatarsim.jit.kept import AVATAR, BODY, COUNT, COUNT_OR_NONE, FLAG, PIECE, Whole
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Cube, FlagLine, Grid, IndexGrid, IndexLine, Line, Matrices, Vectors
from avatarsim.jit.record import known_as_table
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.model.skeleton import Posture, Skeleton
from avatarsim.spatial.vec3 import Vec3, put_row, row

Array = NDArray[np.float64]
Index = NDArray[np.int64]

SLOTS_PER_PIECE = 32
"""Slots for each driven piece. A hand of 24 hinges has some ten near pairs a piece."""

PROBES = 8
"""Slots searched for a pair; if all are taken the one unused for longest is given up, which costs a query and nothing else."""

EMPTY = -1


class PairCache(NamedTuple):
    """key (n) of the pair in a slot, or EMPTY; used (n) step of its last query; axis (n, 3) the direction that last held, a unit
    vector out of the second piece into the first, zero if none has; axis_gap (n) its gap [m] at the shown state, right if
    axis_step (n) is the present one; normal (n, 3), gap (n) nearest direction and gap [m] at the shown state, right if gap_step
    (n) is the present one; step (1): number of the present step; pieces (1): how many there are."""

    key: Annotated[IndexLine, Whole(EMPTY, lambda sizes: sizes.pieces**2 - 1)]
    used: Annotated[IndexLine, COUNT]
    axis: Vectors
    axis_gap: Line
    axis_step: Annotated[IndexLine, COUNT_OR_NONE]
    normal: Vectors
    gap: Line
    gap_step: Annotated[IndexLine, COUNT_OR_NONE]
    step: Annotated[IndexLine, COUNT]
    pieces: Annotated[IndexLine, Whole(lambda sizes: sizes.pieces, lambda sizes: sizes.pieces)]


def make_pair_cache(driven: int, pieces: int) -> PairCache:
    """Return an empty table for so many driven pieces among all."""
    n = 64
    while n < SLOTS_PER_PIECE * driven:
        n *= 2
    return PairCache(
        np.full(n, EMPTY, dtype=np.int64), np.zeros(n, dtype=np.int64), np.zeros((n, 3)), np.zeros(n), np.full(n, -1,
        dtype=np.int64),
        np.zeros((n, 3)), np.zeros(n), np.full(n, -1, dtype=np.int64), np.zeros(1, dtype=np.int64),
        np.full(1, pieces, dtype=np.int64),
    )


@kernel
def slot_of(cache_out: PairCache, a: int, b: int) -> int:
    """Return the slot of a pair, made empty for it if it had none."""
    c = cache_out
    key, mask, now = a * c.pieces[0] + b, c.key.shape[0] - 1, c.step[0]
    # the golden ratio spreads neighbours, which scene files make of pieces that belong together
    place = ((key * 0x9E3779B1) >> 8) & mask
    oldest, found = now + 1, place
    for probe in range(PROBES):
        at = (place + probe) & mask
        if c.key[at] == key:
            c.used[at] = now
            return int(at)
        age = -1 if c.key[at] == EMPTY else c.used[at]
        if age < oldest:
            oldest, found = age, at
    c.key[found], c.used[found], c.axis_step[found], c.gap_step[found] = key, now, -1, -1
    put_row(c.axis, found, (0.0, 0.0, 0.0))
    return int(found)


@kernel
def axis_at(cache: PairCache, at: int) -> Vec3:
    """Return the direction that last held for the pair in a slot."""
    return row(cache.axis, at)


@kernel
def keep_axis(cache_out: PairCache, at: int, n: Vec3) -> None:
    """Keep n as the pair's direction; its gap at the shown state is not known yet."""
    put_row(cache_out.axis, at, n)
    cache_out.axis_step[at] = -1


@kernel
def forget_pairs(cache_out: PairCache) -> None:
    """Drop all that is known."""
    cache_out.key[:] = EMPTY


Flags = NDArray[np.bool_]

ROWS_PER_AVATAR, ROWS_MOST = 96, 768
"""Most constraint rows of an island, per avatar in the scene and in all; more are counted as dropped, and the certificate refuses
steps that they would have prevented."""

TOUCHING_PER_AVATAR = 64
"""Most pairs per avatar that have a row before anything fails; a pair that does not fit gets one when it fails."""

ACTIVE_CAP = 32
"""Most rows of the active set that is solved exactly; with more of them the answer of projected Gauss-Seidel is taken. Fewer:
that is so where a hand grips; more: its factor takes the time of the frame."""

MOST_PRESSED = 1e4
"""A multiplier beyond this means that the conditions cannot all be met, as between two walls, where it would grow without end.
Sweeps end there, and the certificate refuses their result."""


class RowKind(IntEnum):
    """Kind of a constraint row."""

    CONTACT = 0
    """A pair of pieces keeps a gap [m]."""
    LIMIT = 1
    """A ball joint stays within its swing, twist or reach [rad]."""
    BOUND = 2
    """One degree of freedom stays within its budget or its hinge's limits [rad or m]."""
    BUDGET = 3
    """A root or a joint of several degrees stays within its budget along one direction [m or rad]."""
    FRICTION = 4
    """A contact does not slip along one direction [m], unless that takes a larger multiplier than friction allows."""


class Mode(IntEnum):
    """Target that an avatar follows."""

    TRACK = 0
    """The tracker's posture."""
    WAIT = 1
    """The tracker's posture, but the objective no longer falls: something blocks the avatar."""
    PLAN = 2
    """The tracker's posture, while a path is searched."""
    FOLLOW_PATH = 3
    """The planner's path to a posture near the tracker's."""


TRACKING = np.dtype(
    [
        ("mode", "i8"), ("share", "f8"), ("keep", "f8"), ("frame_time", "f8"), ("speed", "f8"), ("ease", "f8"),
        ("stalled", "f8"), ("since", "f8"), ("objective", "f8"), ("distance", "f8"), ("reach", "f8"), ("island", "i8"),
        ("is_legal", "i8"), ("has_failed", "i8"), ("is_certified", "i8"), ("has_model", "i8"), ("is_located", "i8"),
        ("has_arrived", "i8"), ("is_straight", "i8"), ("is_led", "i8"),
    ],
    align=True,
)
"""One row of Tracking."""


class Tracking(np.recarray[Any, np.dtype[Any]]):
    """One row per avatar."""

    mode: Annotated[NDArray[np.int64], Whole(min(Mode), max(Mode))]
    """A Mode."""
    share: Array
    """Share of the Newton step that a step takes."""
    keep: Array
    """Share of its momentum that an avatar keeps in a frame; 0: it has none."""
    frame_time: Array
    """[s] of the last frame; 0 before the first."""
    speed: Array
    """Of the fastest target in the island, low-passed over the settle time: the largest number among its joints [rad/s] and its
    roots [m/s]."""
    ease: Array
    """Share of the catch-up speeds that it may use: 0 while a load moves it in the upper loop, and 1 the settle time later."""
    stalled: Array
    """[s] for which the objective has not fallen as it does where an avatar makes progress."""
    since: Array
    """[s] since the reference of the objective was measured."""
    objective: Array
    """[m^2] the reference of the objective."""
    distance: Array
    """[m] distance of the link origin that is farthest from its target, as the frame ends."""
    reach: Array
    """[m] mean reach of a link: the length that turns radians into metres."""
    island: Annotated[Index, AVATAR]
    """The avatar with the least number in the same island."""
    is_legal: Annotated[Index, FLAG]
    """1 if the tracker's posture keeps all limits: then the target is that posture, the straight way may end at it, and the
    budget of a frame is of its motion."""
    has_failed: Annotated[Index, FLAG]
    """1 if a pair or a limit of this avatar failed at the trial."""
    is_certified: Annotated[Index, FLAG]
    """1 if nothing of this avatar failed at this very trial, so that only changes by the others are checked again."""
    has_model: Annotated[Index, FLAG]
    """1 if the model of this step, with its metric, is at hand."""
    is_located: Annotated[Index, FLAG]
    """1 if the link origins of the tracker's posture are at hand."""
    has_arrived: Annotated[Index, FLAG]
    """1 if the last step ended at the tracker's posture."""
    is_straight: Annotated[Index, FLAG]
    """1 if the last step was the straight way to the target, in which all of a frame's motion is."""
    is_led: Annotated[Index, FLAG]
    """1 if something other than the tracker led it in the last frame: a path or a load."""


known_as_table(Tracking, TRACKING)


class Avatars(NamedTuple):
    """Constants of the avatars: first_link, first_dof (na + 1); avatar (nl) of a link; joint_of (nd) the link of a degree; path
    (nd, w) the degrees that carry degree j, and with couplings its ancestors in the elimination tree, from the root on, itself at
    place depth[j] of them; material (nb) of links and fixed bodies, -1 of bodies on which links have no friction, and friction
    (nm, nm) of pairs of materials; turn_weight (nd) [m^2] of a squared angle, [1] of the squared way of a slide, 0 for
    translations of a root; link_weight (nl) of a squared distance of a link's origin."""

    first_link: IndexLine
    first_dof: IndexLine
    avatar: IndexLine
    joint_of: IndexLine
    path: IndexGrid
    depth: IndexLine
    turn_weight: Line
    link_weight: Line
    material: IndexLine
    friction: Grid


class Rig(NamedTuple):
    """Constants of a world as its avatars have them: the shapes, all trees, and each avatar's part of these."""

    geo: Geometry
    skel: Skeleton
    avatars: Avatars


class Budget(NamedTuple):
    """Motion that the avatars may make in this frame: turn (nl) [rad] of each joint, move (nl) [m] of each root or slide; turned,
    moved (nl) the used part of these along the path so far; slack (2) [m, rad] of a step of the QP beyond its budget."""

    turn: Line
    move: Line
    turned: Line
    moved: Line
    slack: Line


class Contacts(NamedTuple):
    """The active contacts of the last solved step: used (1) how many; pair (m, 2) pieces; normal (m, 3) unit vectors out of the
    second into the first; multiplier (m) [m], how hard the objective [m^2] presses."""

    used: Annotated[IndexLine, COUNT]
    pair: Annotated[IndexGrid, PIECE]
    normal: Vectors
    multiplier: Line


def make_contacts(room: int) -> Contacts:
    """Return room for so many contacts, of which there are none yet."""
    none = np.zeros((room, 2), dtype=np.int64)
    return Contacts(np.zeros(1, dtype=np.int64), none, np.zeros((room, 3)), np.zeros(room))


class Touching(NamedTuple):
    """Pairs that were in contact lately, and so have a row in the next step before anything fails: used (1) how many; pair (m, 2)
    pieces; age (m) steps since the row was last active."""

    used: Annotated[IndexLine, COUNT]
    pair: Annotated[IndexGrid, PIECE]
    age: Annotated[IndexLine, COUNT]


class Inertia(NamedTuple):
    """Velocities of the avatars, as displacements in a frame.

    shown     posture at the start of the frame
    walk      (nd) displacement of the last frame, scaled to the length of this one
    momentum  (nd) initial velocity relative to the target
    target_motion  (nd) displacement of the clipped target in this frame
    gone      (nd) displacement relative to the target so far in this frame
    """

    shown: Posture
    walk: Line
    momentum: Line
    target_motion: Line
    gone: Line


class IkState(NamedTuple):
    """State that stays from frame to frame.

    tracking          a row per avatar
    target_before, tracker_before   the clipped target and the tracker's posture of the last frame; from
                      `open_budgets` on, of this one
    force             (nl, 3) [m] force of the contacts of the last step on each link: multipliers times normals, a
                      gradient of the objective [m^2]
    curvature         (nl) [m^2] the inertia by which these forces bend the Lagrangian
    contacts          that were active in the last solved step
    touching          pairs that were in contact lately
    pairs             last data of each pair of pieces
    near, near_count  (na, nb), (na) bodies that are no links and in reach of an avatar, and how many
    near_box          (na, 6) [m] low x, y, z and high x, y, z of an avatar, for which the list is good
    axes              (nd, 3) world axes of the degrees at the shown posture
    budget            rest of the motion of this frame
    inertia           how the avatars move
    """

    tracking: Tracking
    target_before: Posture
    tracker_before: Posture
    force: Vectors
    curvature: Line
    contacts: Contacts
    touching: Touching
    pairs: PairCache
    near: Annotated[IndexGrid, BODY]
    near_count: Annotated[IndexLine, Whole(0, lambda sizes: sizes.bodies)]
    near_box: Grid
    axes: Vectors
    budget: Budget
    inertia: Inertia


class Objective(NamedTuple):
    """The quadratic model of one step: origin, frame the link origins (nl, 3) and rotations (nl, 3, 3) of the tracker's
    posture; aim (nl, 3) these origins drawn near; error (nd) the tangent error to the clipped target; target_motion (nd)
    the part of the target's motion in this frame that is still to be followed; number, inertia (nl), first, attraction, load (nl,
    3), second, twist (nl, 3, 3) moments that `gather` sums up the trees; motion (nd, 6) of each degree; factor (nd, w) of
    the metric; newton (nd) the step to the least of the model."""

    origin: Vectors
    frame: Matrices
    aim: Vectors
    error: Line
    target_motion: Line
    number: Line
    inertia: Line
    first: Vectors
    attraction: Vectors
    load: Vectors
    second: Matrices
    twist: Matrices
    motion: Grid
    factor: Grid
    newton: Line


class ConstraintRows(NamedTuple):
    """Linear conditions J x >= bound of one step: used, ready (1 each) how many there are, and how many are transformed; kind
    (m) a RowKind; pair (m, 2) pieces of a contact, or a degree and -1; owner (m, 2) avatars whose degrees a row is of, -1 for
    none; jacobian (m, nd); weighted (m, nd) = L^-T J^T; multiplier, residual, before (m); least, most (m) of
    a multiplier, 0 and MOST_PRESSED but for friction, whose rows are equations;
    normal (m, 3), arm (m, 6) [m] from the origins of both bodies to the contact; gram (m, m) of the weighted rows; is_solved (1)
    whether the sweeps came to an end; active (a) the active rows, factor (a, a) of
    their Gram matrix, change (a) of their multipliers."""

    used: IndexLine
    ready: IndexLine
    kind: IndexLine
    pair: IndexGrid
    owner: IndexGrid
    jacobian: Grid
    weighted: Grid
    bound: Line
    multiplier: Line
    least: Line
    most: Line
    residual: Line
    before: Line
    normal: Vectors
    arm: Grid
    gram: Grid
    is_solved: FlagLine
    factor: Grid
    active: IndexLine
    change: Line


class Failed(NamedTuple):
    """Pairs that failed at the last trial: used (1) how many, pair (m, 2)."""

    used: IndexLine
    pair: IndexGrid


class IkScratch(NamedTuple):
    """Working memory of a frame. target: the clipped target; trial: poses of the step that is tested, with axes (nd, 3); swept
    (ns, 6), swept_links (nb, 6), swept_avatars (na, 6): boxes around both ends of it; low, high, step (nd): bounds, and the step;
    still (nd) zero; members (na) avatars of the islands one after the other, is_active (na) 1 for those of the island that is
    solved for; trail (K, nl, 12) positions [m] and rotations of links after each of the first K steps of a frame."""

    target: Posture
    trial: Poses
    axes: Vectors
    swept: Grid
    swept_links: Grid
    swept_avatars: Grid
    low: Line
    high: Line
    step: Line
    still: Line
    members: IndexLine
    is_active: IndexLine
    objective: Objective
    rows: ConstraintRows
    failed: Failed
    narrow: Scratch
    counts: IndexLine
    trail: Cube


COUNT_NAMES = (
    "queries", "forwards", "supports", "sweeps", "rows", "steps", "backed_off", "held", "pairs", "rows_dropped", "iterations",
    "bad_queries", "waiting", "out_of_work", "adopted", "avatar_islands", "products", "planning", "following", "plan_work",
)
"""Counts of a frame; `held`: avatars whose step came to nothing; `products`: inner products of rows; `plan_work`: work of
searches, in addition to the rest."""

(
    QUERIES, FORWARDS, SUPPORTS, SWEEPS, ROWS, STEPS, BACKED, HELD, PAIRS, DROPPED, QPS, BAD_QUERIES, WAITING, OUT_OF_WORK,
    ADOPTED, ISLANDS, PRODUCTS, PLANNING, FOLLOWING, PLAN_WORK,
) = range(len(COUNT_NAMES))


def names_pieces(geo: Geometry, skel: Skeleton, pairs: NDArray[np.int64]) -> bool:
    """Return True if every pair (k, 2) is a driven piece and a piece."""
    first, pieces = int(geo.first_shape[skel.first]), len(geo.body)
    driven, other = pairs[:, 0], pairs[:, 1]
    return bool(((driven >= first) & (driven < pieces) & (other >= 0) & (other < pieces)).all())


def state_is_sound(geo: Geometry, skel: Skeleton, avatars: Avatars, state: IkState) -> bool:
    """Return True if all indices in the state are valid: pairs in contact, bodies in reach, islands."""
    for listed, room in ((state.contacts, len(state.contacts.pair)), (state.touching, len(state.touching.pair))):
        count = int(listed.used[0])
        if not 0 <= count <= room or not names_pieces(geo, skel, listed.pair[:count]):
            return False
    islands = state.tracking["island"]
    if not ((islands >= 0) & (islands <= np.arange(len(islands)))).all():
        return False
    return all(
        count <= len(row) and bool((row[:count] < skel.first).all())
        for row, count in zip(state.near, state.near_count.tolist(), strict=True)
    )
