"""The step that is wanted: the straight one to the tracker's posture inside its limits while nothing is in the way.

Where a contact is, or the tracker is beyond its limits, the one to the posture that is nearest in link origins and angles
(`closeness.py`) to the tracker's own.
"""

from math import sqrt

from avatarsim.kernel import kernel
from avatarsim.posture.closeness import couple, gain_of, locate, merit_of
from avatarsim.posture.goal import shorten, want, ways
from avatarsim.posture.limit_row import is_beyond
from avatarsim.posture.limits import has_cone
from avatarsim.posture.round_edges import round_edges
from avatarsim.posture.workspace import (
    ADDING,
    BEST,
    BEYOND,
    BOUND,
    BUILT,
    COUNT,
    COUPLED,
    LOCATED,
    TRACKER_SPEED,
    Goal,
    Memory,
    Rows,
)
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import put_row, row
from avatarsim.world.geometry import Array, Geometry, Poses
from avatarsim.world.skeleton import BALL, Posture, Skeleton

FIRST_PART = 0.02
"""[rad] part of a ball's wanted step that is looked at first. A limb pressed on its limits is beyond them there already; at
the end of the step the nearest place of a cone is another one, and what keeps the limb there lets it not slide where it is."""


@kernel
def loses_merit(settings: PostureSettings, memory: Memory) -> bool:
    """Whether the step moves more than the tracker does and yet, by the model, does not bring the posture nearer to it: what was
    cut from a step may lead away.

    Without this test limbs circle for ever around an obstacle before a resting tracker.
    """
    goal, x = memory.goal, memory.rows.x
    gain, square, largest = 0.0, 0.0, 0.0
    for part in x:
        largest = max(largest, abs(part))
    if largest <= 1e-4 + 2.0 * memory.flags[TRACKER_SPEED]:
        return False
    if goal.closeness.mode[COUPLED] > 0.0:
        gain, square = gain_of(goal.closeness, goal.closeness.pull, x)
    else:
        for j in range(x.shape[0]):
            gain += (goal.full[j] - 0.5 * x[j]) * x[j] / goal.inverse_weight[j]
            square += x[j] * x[j] / goal.inverse_weight[j]
    return not (gain >= settings.merit * square)


@kernel
def scale_step(goal_out: Goal) -> None:
    """Make the wanted step, and the bounds around it, as short as this attempt takes them."""
    for j in range(goal_out.step.shape[0]):
        goal_out.step[j] *= goal_out.share[j]
        goal_out.low[j] *= goal_out.share[j]
        goal_out.high[j] *= goal_out.share[j]


@kernel
def seek_the_nearest(
    geo: Geometry, skel: Skeleton, posture: Posture, poses: Poses, settings: PostureSettings, memory_out: Memory
) -> None:
    """Make the wanted step the one to the least merit in link origins and angles, and its second derivatives the metric."""
    goal = memory_out.goal
    c = goal.closeness
    if c.mode[LOCATED] == 0.0:
        want(skel, posture, goal)
        if c.mode[BEYOND] > 0.0:
            # how near the limits let the tracker's posture be when each joint cares for itself alone
            locate(skel, goal.tracker, c)
            for link in range(skel.kind.shape[0]):
                put_row(c.way, link, row(c.there, link))
            locate(skel, goal.own, c)
            ways(skel, goal.tracker, goal.own, c.pull)
            c.mode[BEST] = merit_of(c, c.way, c.pull)
        else:
            locate(skel, goal.tracker, c)
        round_edges(geo, skel, poses, memory_out)
    c.mode[LOCATED] = 1.0
    couple(skel, memory_out.axes, goal.wanted, c)
    shorten(skel, posture, settings, c.pull, goal)
    scale_step(goal)
    c.mode[COUPLED] = 1.0
    weigh_anew(memory_out.rows)


@kernel
def weigh_anew(rows_out: Rows) -> None:
    """Forget what the rows weigh in the metric before, and the bounds of the step before."""
    r, kept = rows_out, 0
    for k in range(r.size[COUNT]):
        if r.pair[k, 0] == BOUND:
            continue
        if kept < k:
            for j in range(r.x.shape[0]):
                r.jacobian[kept, j] = r.jacobian[k, j]
            r.bound[kept] = r.bound[k]
            put_row(r.normal, kept, row(r.normal, k))
            for i in range(6):
                r.arms[kept, i] = r.arms[k, i]
            r.pair[kept, 0], r.pair[kept, 1] = r.pair[k, 0], r.pair[k, 1]
        r.multiplier[kept] = 0.0
        kept += 1
    r.size[COUNT], r.size[BUILT] = kept, 0


@kernel
def hindered(wanted: Array, rows: Rows) -> bool:
    """Whether the wanted step breaks the row of a contact."""
    for k in range(rows.size[COUNT]):
        if rows.pair[k, 0] < 0:
            continue
        reached = 0.0
        for j in range(wanted.shape[0]):
            reached += rows.jacobian[k, j] * wanted[j]
        if not (reached >= rows.bound[k]):
            return True
    return False


@kernel
def keep_limits(skel: Skeleton, posture: Posture, memory_out: Memory) -> None:
    """Rows for balls that the wanted step turns over their limits, where it meets these: known before anything is solved."""
    step, x = memory_out.goal.step, memory_out.rows.x
    memory_out.flags[ADDING] = 1.0
    for link in range(skel.kind.shape[0]):
        if skel.kind[link] != BALL or not has_cone(skel, link):
            continue
        d = skel.first_dof[link]
        far = sqrt(step[d] ** 2 + step[d + 1] ** 2 + step[d + 2] ** 2)
        share = FIRST_PART / max(far, FIRST_PART)
        for _ in range(2):
            for j in range(d, d + 3):
                x[j] = share * step[j]
            if is_beyond(skel, posture, link, memory_out) or share == 1.0:
                break
            share = 1.0
