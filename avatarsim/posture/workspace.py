"""Memory of the posture solver: made once per scene, so that the kernels allocate nothing."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.scratch import Scratch, make_scratch
from avatarsim.posture.jointed import has_joints
from avatarsim.posture.kinematics import forward
from avatarsim.posture.metric import metric
from avatarsim.posture.turn_weight import FAR, mean_reach, turn_weight
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import FREE, Posture, Skeleton

Array = NDArray[np.float64]
Index = NDArray[np.int64]

ROW_CAP = 96
"""Most contact and bound rows of one step. The slowest frames of hostile motion used a dozen; more are counted as dropped."""

PRESSING_CAP = 32
"""Most rows that press at once and are solved for together; with more of them the sweeps' answer is taken."""

LISTED_CAP = 64
"""Most pairs that get a row before anything fails; a pair that does not fit gets one when it fails."""

FAILED_CAP = 64
"""Most failed pairs that are remembered by name; further ones are only counted."""

# counts of one frame, by place in Memory.counts
QUERIES, FORWARDS, SUPPORTS, SWEEPS, ROWS, STEPS, BACKED, HELD, NEAR, DROPPED, ITERATIONS, RESYNCS, BAD_QUERIES = range(13)
LED_STEPS, TRAPPED_FRAMES, WALLED_FRAMES, CROSSINGS, LEAPS, ADOPTED = range(13, 19)
COUNT_NAMES = (
    "queries", "forwards", "supports", "sweeps", "rows", "steps", "backed_off", "held", "pairs", "rows_dropped", "iterations",
    "resyncs", "bad_queries", "led", "trapped", "walled", "crossings", "leaps", "adopted",
)


class Closeness(NamedTuple):
    """The measure of nearness to the tracker's posture (`closeness.py`): what it is of, and its second derivatives, factored.

    path (nd, w) degrees that carry degree j, from the root on, itself at place depth[j]; root (nl) of a link's tree; turn_weight
    (nd) [m^2] of a squared angle, 0 for translations; here, there (nl, 3) [m] link origins of the checked and the tracker's
    posture; frame (nl, 3, 3) of the latter; number (nl), first, way (nl, 3), second, moment (nl, 3, 3) see `gather`; motion
    (nd, 6) see `note_motions`; factor (nd, w); pull (nd) the step to the least merit; far (1) [m] distance beyond which an
    origin pulls no harder; mode, see the places below; around (nl, 3) [m] how far `there` is put aside (`round_edges.py`); press
    (nl, 3) contact forces on the links in the last step, leverage (nl, 3, 3) their moments about the links' origins; load (nl, 3)
    and bending (nl, 3, 3) the same of all that a link carries, pulls included in the latter; curvature (nd): see `curvature.py`
    """

    path: Index
    depth: Index
    root: Index
    turn_weight: Array
    here: Array
    there: Array
    frame: Array
    number: Array
    first: Array
    way: Array
    second: Array
    moment: Array
    motion: Array
    factor: Array
    pull: Array
    far: Array
    mode: Array
    around: Array
    press: Array
    leverage: Array
    load: Array
    bending: Array
    curvature: Array


# places in Closeness.mode: 1 if the rows of this step are weighed by the factor; mean squared excess [rad^2] of the tracker's
# links over the limits of their joints; 1 if `there` is that of this frame; the merit of the tracker's posture inside its limits,
# -1 if nobody has asked in this frame; the frame in which `around` was last in use; 1 if no avatar has joints
COUPLED, BEYOND, LOCATED, BEST, SEEN, RIGID = range(6)

BOUND = -1  # Rows.pair[k, 0] of a row that is a bound of one degree of freedom


class Goal(NamedTuple):
    """The way to the tracker's posture in the tangent space.

    full (nd) all of it; step (nd) capped; low, high (nd) bounds of this step; trust in (0, 1]: share of the caps that steps have
    in this frame, in one number (1); share (nd) of the wanted step that this attempt takes, one for all of an avatar;
    inverse_weight (nd); tracker Posture inside the limits; previous tracker posture; own posture of the tracker,
    limits or not; wanted (nd) the way there; closeness the measure of nearness; begun the posture in which the frame began;
    leapt (nl, 2) how far each user went in this frame [m], and the most that one of their joints turned [rad], in the row of the
    root; allowed (nd) share of a step, 0 for what has gone as far as it may (`leap.py`, `again.py`); slow (nl) frames in which
    each root's avatar came no nearer, past (nl, PAST_FRAMES) its merits, led (nl) 1 for roots for which a way is sought
    (`behind.py`); gone (nl, 2) how far each root [m] and each joint [rad] has gone along its path in this frame
    (`motion_budget.py`)
    """

    full: Array
    step: Array
    low: Array
    high: Array
    trust: Array
    share: Array
    inverse_weight: Array
    tracker: Posture
    before: Posture
    own: Posture
    wanted: Array
    closeness: Closeness
    begun: Posture
    leapt: Array
    allowed: Array
    slow: Array
    past: Array
    led: Array
    gone: Array


class Rows(NamedTuple):
    """Linear conditions J x >= c of one step and the dual solver's memory.

    jacobian, weighted (M, nd); bound, multiplier, residual (M); gram (M, M); pair (M, 2) shapes, or (-1, dof) for a bound;
    normal (M, 3) of a contact, out of its second piece into its first; arms (M, 6) [m] from the origins of the two bodies to it;
    x (nd) the solution; here (nd) zero: the checked state; size (2) rows, and rows whose gram entries are up to date; pressing
    (A) rows whose multiplier is above zero, factor (A, A) of their gram matrix, change (A) of their multipliers, before (M) what
    all multipliers were (`active_set.py`)
    """

    jacobian: Array
    weighted: Array
    bound: Array
    multiplier: Array
    residual: Array
    gram: Array
    pair: Index
    x: Array
    here: Array
    size: Index
    pressing: Index
    factor: Array
    change: Array
    before: Array
    normal: Array
    arms: Array


class PairMemory(NamedTuple):
    """What is known of pairs of pieces: rows are driven pieces (from `first` on), columns all pieces.

    axis (D, S, 3) last direction that held; axis_gap (D, S) its gap at the checked state, valid when axis_stamp == now;
    nearest (D, S, 3), nearest_gap (D, S) exact at the checked state, valid when nearest_stamp == now;
    active (D, S) whether listed; listed (64, 2), age (64); failed (64, 2); marks: now, listed, failed, near bodies,
    near pairs of the last trial
    """

    axis: Array
    axis_gap: Array
    axis_stamp: Index
    nearest: Array
    nearest_gap: Array
    nearest_stamp: Index
    active: NDArray[np.bool_]
    listed: Index
    age: Index
    failed: Index
    near: Index
    marks: Index


NOW, LISTED, FAILED, NEARBY, ASKED = range(5)


class Memory(NamedTuple):
    """Everything the posture solver keeps: trial poses, world axes of the checked and the trial state, and the parts above; trail
    (K, nl, 12) positions [m] and rotations of links after each of the first K adopted steps of a frame (`trail.py`).

    Modes and counts that vary from call to call stand in `flags` and `rows.size` and not in arguments: the compiler makes a
    version of a kernel, and of all it calls, for every constant argument that it sees.
    """

    trial: Poses
    axes: Array
    trial_axes: Array
    swept: Array
    swept_hulls: Array
    reach: Array
    goal: Goal
    rows: Rows
    pairs: PairMemory
    touched: NDArray[np.bool_]
    flags: Array
    counts: Index
    scratch: Scratch
    trail: Array


# places in Rows.size
COUNT, BUILT = range(2)

# places in Memory.flags
(
    TRACKER_SPEED, STUCK, STUCK_ERROR, FRAME, ADDING, SOFT, SLOW, LED, TRAPPED, WALLED, SPEED, STEPPED,
    PRESSED, CALM, RESTED, CLOSE, LEAP,
) = range(17)

# values of LED: the shown avatar waits where it is while a way is searched; it goes along a way that was found
HELD_STILL, UNDER_WAY = 1.0, 2.0

PAST_FRAMES = 6
"""Frames over which coming nearer is judged."""

WORKING = ("trail", "counts", "goal.closeness.path", "goal.closeness.depth", "goal.closeness.root", "rows.pressing")
"""Parts of a Memory that hold nothing from frame to frame, or never change."""


def _posture(nl: int, nd: int) -> Posture:
    return Posture(np.zeros((nl, 3)), np.tile(np.eye(3), (nl, 1, 1)), np.zeros(nd))


def _closeness(skel: Skeleton) -> Closeness:
    """Arrays of the measure, angles weighing as if every link reached 1 m."""
    nl, nd = len(skel.kind), int(skel.first_dof[-1])
    owner = np.repeat(np.arange(nl), np.diff(skel.first_dof))
    paths = [[i for i in range(j + 1) if skel.related[owner[j], owner[i]]] for j in range(nd)]
    depth = np.array([len(path) - 1 for path in paths], dtype=np.int64)
    path = np.zeros((nd, max((len(path) for path in paths), default=1)), dtype=np.int64)
    for j, degrees in enumerate(paths):
        path[j, : len(degrees)] = degrees
    root = np.arange(nl)
    for link in np.flatnonzero(skel.parent >= 0).tolist():
        root[link] = root[skel.parent[link]]
    turning = np.ones(nd)
    for link in np.flatnonzero(skel.kind == FREE).tolist():
        turning[skel.first_dof[link] : skel.first_dof[link] + 3] = 0.0
    rigid = 0.0 if has_joints(skel) else 1.0
    return Closeness(
        path, depth, root, turning, np.zeros((nl, 3)), np.zeros((nl, 3)), np.zeros((nl, 3, 3)), np.zeros(nl), np.zeros((nl, 3)),
        np.zeros((nl, 3)), np.zeros((nl, 3, 3)), np.zeros((nl, 3, 3)), np.zeros((nd, 6)), np.zeros(path.shape), np.zeros(nd),
        np.ones(1), np.array([0.0, 0.0, 0.0, -1.0, -1.0, rigid]), np.zeros((nl, 3)),
        np.zeros((nl, 3)), np.zeros((nl, 3, 3)), np.zeros((nl, 3)), np.zeros((nl, 3, 3)), np.zeros(nd),
    )


def make_memory(geo: Geometry, skel: Skeleton, poses: Poses, kept: int = 0) -> Memory:
    """Fresh memory for a world whose bodies stand at `poses`, with room for the poses of `kept` steps of a frame."""
    nl, nd, ns, nb = len(skel.kind), int(skel.first_dof[-1]), len(geo.body), len(geo.first_shape) - 1
    driven = ns - int(geo.first_shape[skel.first])
    goal = Goal(
        np.zeros(nd), np.zeros(nd), np.zeros(nd), np.zeros(nd), np.ones(1), np.ones(nd), np.ones(nd), _posture(nl, nd),
        _posture(nl, nd), _posture(nl, nd), np.zeros(nd), _closeness(skel), _posture(nl, nd),
        np.zeros((nl, 2)), np.ones(nd), np.zeros(nl), np.zeros((nl, PAST_FRAMES)), np.zeros(nl), np.zeros((nl, 2)),
    )
    rows = Rows(
        np.zeros((ROW_CAP, nd)), np.zeros((ROW_CAP, nd)), np.zeros(ROW_CAP), np.zeros(ROW_CAP), np.zeros(ROW_CAP),
        np.zeros((ROW_CAP, ROW_CAP)), np.zeros((ROW_CAP, 2), dtype=np.int64), np.zeros(nd), np.zeros(nd),
        np.zeros(2, dtype=np.int64), np.zeros(PRESSING_CAP, dtype=np.int64), np.zeros((PRESSING_CAP, PRESSING_CAP)),
        np.zeros(PRESSING_CAP), np.zeros(ROW_CAP), np.zeros((ROW_CAP, 3)), np.zeros((ROW_CAP, 6)),
    )
    none = np.full((driven, ns), -1, dtype=np.int64)
    pairs = PairMemory(
        np.zeros((driven, ns, 3)), np.zeros((driven, ns)), none.copy(),
        np.zeros((driven, ns, 3)), np.zeros((driven, ns)), none.copy(),
        np.zeros((driven, ns), dtype=np.bool_), np.zeros((LISTED_CAP, 2), dtype=np.int64), np.zeros(LISTED_CAP, dtype=np.int64),
        np.zeros((FAILED_CAP, 2), dtype=np.int64), np.zeros(nb, dtype=np.int64), np.zeros(5, dtype=np.int64),
    )
    trial = Poses(*(array.copy() for array in poses))
    return Memory(
        trial, np.zeros((nd, 3)), np.zeros((nd, 3)), poses.boxes.copy(), poses.hulls.copy(), np.zeros(6), goal, rows, pairs,
        np.zeros(nl, dtype=np.bool_), np.zeros(LEAP + 1), np.zeros(len(COUNT_NAMES), dtype=np.int64), make_scratch(),
        np.zeros((kept, nl, 12)),
    )


def ready_memory(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, kept: int = 0
) -> Memory:
    """Memory for a world at its first posture, with the metric of that posture and room for `kept` steps of a frame."""
    memory = make_memory(geo, skel, poses, kept)
    forward(geo, skel, posture, memory.rows.x, poses, memory.axes)
    memory.goal.inverse_weight[:] = 1.0 / metric(geo, skel, poses, memory.axes, settings)
    for before, now in zip(memory.goal.before, posture, strict=True):
        # a user who begins where the avatar does has not leapt there
        np.copyto(before, now)
    measure = memory.goal.closeness
    measure.turn_weight[:] *= turn_weight(geo, skel, poses, settings)
    measure.far[0] = FAR * mean_reach(geo, skel, poses)
    return memory
