"""What to do when the avatar is stuck although the user's own posture is free: forget, then untie by a stated jump."""

from avatarsim.collide.support import gap_along
from avatarsim.kernel import kernel
from avatarsim.posture.behind import judge_anew
from avatarsim.posture.certificate import nearest_direction
from avatarsim.posture.certify import boxes_meet, certify_pair, is_no_pose, sweep_boxes
from avatarsim.posture.goal import farthest, measure_way
from avatarsim.posture.step import adopt, try_step
from avatarsim.posture.workspace import (
    ADDING,
    CALM,
    LISTED,
    PRESSED,
    RESYNCS,
    STUCK,
    STUCK_ERROR,
    Memory,
)
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import row, sub
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.pair_filter import may_meet
from avatarsim.world.skeleton import Posture, Skeleton

ERROR = 0.1
"""[rad or m] an avatar nearer than this to the tracker's posture in every joint is not stuck."""

PROGRESS = 0.02
"""[rad or m] a change of the largest error by more than this within a frame is progress."""

FORGET_AT = 5
"""Frames without progress after which shrunk trust, listed pairs and directions are forgotten: they can poison the way."""

CALM_FRAMES = 60
"""Frames for which a tracker rests, after which nothing is forgotten any more: each time limbs look for another place to rest."""


@kernel
def unstick(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, posture_out: Posture, poses_out: Poses, memory_out: Memory
) -> None:
    """Count the frames without progress and act on the count."""
    measure_way(skel, posture_out, memory_out.goal)
    error = farthest(memory_out.goal)
    flags = memory_out.flags
    if error > ERROR and abs(error - flags[STUCK_ERROR]) < PROGRESS:
        flags[STUCK] += 1.0
    else:
        flags[STUCK] = 0.0
        flags[STUCK_ERROR] = error
    waited = int(flags[STUCK])
    late = waited - settings.stuck_frames
    if waited > 0 and late >= 0 and late % FORGET_AT == 0 and settings.untie != 0:
        if tracker_is_reachable(geo, skel, posture_out, poses_out, settings, memory_out):
            adopt(geo, skel, posture_out, poses_out, memory_out)
            forget(memory_out)
            memory_out.counts[RESYNCS] += 1
            # it is there, and nothing is left to seek
            measure_way(skel, posture_out, memory_out.goal)
            flags[STUCK] = 0.0
            judge_anew(skel, memory_out)
    elif waited % (FORGET_AT + 1) == FORGET_AT and flags[PRESSED] > 0.0 and flags[CALM] < CALM_FRAMES:
        # with little trust, so that nothing whips; where the tracker's posture is free, `trapped` searches instead
        forget(memory_out)


@kernel
def forget(memory_out: Memory) -> None:
    """Drop every memory that only speeds things up."""
    memory_out.goal.closeness.press[:] = 0.0
    memory_out.goal.closeness.leverage[:] = 0.0
    pairs = memory_out.pairs
    pairs.marks[LISTED] = 0
    for i in range(pairs.active.shape[0]):
        for b in range(pairs.active.shape[1]):
            pairs.active[i, b] = False
            pairs.axis_stamp[i, b] = -1
            pairs.nearest_stamp[i, b] = -1
            for k in range(3):
                pairs.axis[i, b, k] = 0.0


@kernel
def tracker_is_reachable(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, memory_out: Memory
) -> bool:
    """Whether the tracker's posture is free, and everything that is not a link has a direction separating now from there.

    Then a jump there unties limbs from each other and crosses no furniture. The trial holds that posture afterwards.
    """
    for j in range(memory_out.rows.x.shape[0]):
        memory_out.rows.x[j] = memory_out.goal.full[j]
    try_step(geo, skel, posture, memory_out)
    memory_out.flags[ADDING] = 0.0
    if is_no_pose(skel, memory_out):
        return False
    sweep_boxes(geo, skel, poses, settings.least_gap, memory_out)
    hulls, swept = memory_out.swept_hulls, memory_out.swept
    nb = geo.first_shape.shape[0] - 1
    for link in range(skel.first, nb):
        for k in range(nb):
            between_links = k >= skel.first
            if (between_links and k <= link) or k == link:
                continue
            if not boxes_meet(hulls, link, k) or not may_meet(geo.wanted, link, k):
                continue
            for a in range(geo.first_shape[link], geo.first_shape[link + 1]):
                for b in range(geo.first_shape[k], geo.first_shape[k + 1]):
                    if between_links:
                        if not apart_at_trial(geo, a, b, settings.least_gap, memory_out):
                            return False
                    elif boxes_meet(swept, a, b):
                        if not certify_pair(geo, skel, poses, a, b, settings, memory_out):
                            return False
    return True


@kernel
def apart_at_trial(geo: Geometry, a: int, b: int, least: float, memory_out: Memory) -> bool:
    """Whether two links are proved apart by `least` [m] at the trial, whatever lies between."""
    trial = memory_out.trial
    seed = sub(row(trial.vertices, geo.shapes.start[a]), row(trial.vertices, geo.shapes.start[b]))
    gap, n, _ = nearest_direction(geo, trial, seed, a, b, 2.0 * least, memory_out)
    return gap >= least and gap_along(trial.vertices, geo.shapes, a, b, n) >= least
