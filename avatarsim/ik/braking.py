"""Steps of the Shield within limits of speed and acceleration, each of which leaves a proved way to rest.

After each call the uniform braking (`ik.rate_limits`) is proved free. In the tangent space it continues along the line of the
step, so that one certificate, of the way from the shown posture to where the avatar is at rest, covers a step and the way to
rest. A candidate without one, or beyond the limits of a joint at a posture of that way, is refused; the braking itself was
certified in the call before and needs none. So no call is without an answer, and none ends where the avatar could not stop: a
fail-safe trajectory (Pek and Althoff 2021, Fail-safe motion planning for online verification of autonomous vehicles).

The candidate is the step nearest to the wanted one, within limits, that obeys a velocity damper for each near pair (Faverjon
and Tournassoud 1987): a gap falls by no more than leaves the margin when the avatar is at rest. Where its certificate fails
there is a second one that takes no more calls to rest than the braking and has the dampers where the braking ends: that end is
known to be free, and the candidate's is near to it, so that its rows are exact to second order. At last it is drawn towards the
braking.

Rows and bounds are of the step of one call; one that is meant for the whole way is divided by the number of steps in it.
"""

from enum import IntEnum
from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.certificate import nearest_direction
from avatarsim.ik.constraints import add_witness_row, along_row, check_limits, clear_row
from avatarsim.ik.gaps import stand_off_of
from avatarsim.ik.kinematics import take_step
from avatarsim.ik.motion_ccd import MotionSegment, go_along, list_pairs, put_at
from avatarsim.ik.qp import BOUND, BUDGET, CUTS, add_bound, has_bound, solve_dual
from avatarsim.ik.rate_limits import (
    WIDEST_TURN,
    Braking,
    calls_to_rest,
    choose_wanted,
    keep_limits,
    length_of,
    most_calls_to_rest,
    set_bounds,
    set_brake,
    set_caps,
    steps_to_rest,
)
from avatarsim.ik.state import Rig, axis_at, keep_axis, slot_of
from avatarsim.ik.target import clip_avatar, copy_posture
from avatarsim.jit.arena import view_arena
from avatarsim.jit.kernel import entry_kernel, kernel
from avatarsim.jit.layout import Line
from avatarsim.model.conversion import read_sample, write_sample
from avatarsim.model.joint_limits import cone_excess, has_cone
from avatarsim.model.skeleton import BALL, displace
from avatarsim.model.world import WorldParts
from avatarsim.spatial.tangent import columns, stepped
from avatarsim.spatial.vec3 import dot
from avatarsim.tolerances import NOTHING, ROUNDING

Array = NDArray[np.float64]
Index = NDArray[np.int64]

REACH = 0.15
"""[m] pairs nearer than this have a damper. Less: the certificate fails first for pairs that close fast, and the avatar slows
down; more: more rows."""

ANEW = 0.6
"""Share of the margin that dampers at the end of the braking keep. 1: pairs that are at the margin there leave the candidate no
way to be slower than the braking; less: more certificates fail again."""

OPENED = 0.5
"""Share of the fastest opening within limits for a pair below the margin. More: rows of several pairs contradict one another;
less: it opens slowly, and a certificate of a pair that nearly touches takes long."""

DRAWN = (1.0, 0.5, 0.4)
"""Shares of the way from the braking to the last candidate that are tried, each of the rest that the one before it left. Fewer:
it brakes more often; more: slowest calls take longer."""

SOLVED = 1e-3
"""Share of the margin to which rows are solved, in a call. Larger: the certificate sees the residual; smaller: more sweeps."""


class Outcome(IntEnum):
    """Outcomes of a call."""

    BRAKED = 0
    """It continued on the way to rest that was proved in an earlier call."""
    STEPPED = 1
    """It took a step with a proof of its own."""
    ARRIVED = 2
    """It took such a step, and shows the requested posture."""


BRAKED, STEPPED, ARRIVED = (int(one) for one in Outcome)


@kernel
def add_dampers(
    rig: Rig, margin: float, opening: float, base: Line, steps: float, segment_out: MotionSegment, braking_out: Braking
) -> None:
    """Add rows at the posture that so many steps `base` (nd) lead to: of a step that takes its place, the gap of a near pair
    stays at the margin [m] or above; one that is below opens, by at most `opening` [m] a call."""
    c, b = segment_out, braking_out
    s = b.scratch
    copy_posture(rig, 0, b.shown, c.start)
    for j in range(base.shape[0]):
        c.step[j] = steps * base[j]
    c.curvature[:] = 0.0
    put_at(rig.geo, rig.skel, 1.0, c, c.one)
    put_at(rig.geo, rig.skel, 1.0, c, c.other)
    count = list_pairs(rig.geo, rig.skel, REACH, c)
    for k in range(count):
        one, other = c.pending[k, 0], c.pending[k, 1]
        at = slot_of(b.pairs, one, other)
        gap, n, simplex = nearest_direction(rig.geo, c.one, axis_at(b.pairs, at), one, other, REACH, s)
        if dot(n, n) > 0.5:
            keep_axis(b.pairs, at, n)
        if -inf < gap < REACH:
            least = min(stand_off_of(rig.geo, margin, one, other) - gap, steps * opening)
            before = s.rows.used[0]
            add_witness_row(rig, one, other, n, least, simplex, c.one, c.axes, c.step, s)
            divide_bounds(before, steps, b)
            fit_row(before, b)


@kernel
def fit_row(k: int, braking_out: Braking) -> None:
    """Drop row k, the last, if no step within the bounds breaks it; lower one that opens to a share of the allowed motion."""
    s, r, least, most = braking_out.scratch, braking_out.scratch.rows, 0.0, 0.0
    if k >= r.used[0]:
        return
    for j in range(s.low.shape[0]):
        rate = r.jacobian[k, j]
        if rate != 0.0:
            least += rate * (s.low[j] if rate > 0.0 else s.high[j])
            most += rate * (s.high[j] if rate > 0.0 else s.low[j])
    r.bound[k] = min(r.bound[k], max(0.0, OPENED * most))
    if least >= r.bound[k]:
        r.used[0] = k


@kernel
def divide_bounds(first: int, steps: float, braking_out: Braking) -> None:
    """Make rows from `first` on, which are of so many steps, rows of one."""
    rows = braking_out.scratch.rows
    for k in range(first, rows.used[0]):
        rows.bound[k] /= steps


@kernel
def solve(rig: Rig, tolerance: float, braking_out: Braking) -> None:
    """Solve for the trial: the step nearest to the wanted one that keeps rows, bounds and limits. Rows that cannot be met require
    no more than the braking does."""
    b, s, r = braking_out, braking_out.scratch, braking_out.scratch.rows
    for attempt in range(2):
        for j in range(b.trial.shape[0]):
            s.objective.newton[j] = s.step[j] = b.wanted[j]
        if add_broken(b) > 0 or breaks_rows(tolerance, b):
            for _ in range(CUTS):
                solve_dual(b.avatars, 0, 1, tolerance, s)
                if add_broken(b) == 0:
                    break
        for j in range(b.trial.shape[0]):
            s.step[j] = min(max(s.step[j], s.low[j]), s.high[j])
        keep_limits(b, s.step)
        if attempt == 1 or not breaks_rows(10.0 * tolerance, b):
            break
        for k in range(r.used[0]):
            if r.kind[k] != BUDGET and r.kind[k] != BOUND:
                r.bound[k] = min(r.bound[k], along_row(b.avatars, k, b.brake, r.jacobian, r))
            r.multiplier[k] = 0.0
    for j in range(b.trial.shape[0]):
        b.trial[j] = s.step[j]


@kernel
def solve_within(rig: Rig, tolerance: float, steps: float, braking_out: Braking) -> None:
    """Solve as `solve` does, with rows for balls that would be beyond their limits after so many steps of it."""
    b, s = braking_out, braking_out.scratch
    solve(rig, tolerance, b)
    first = s.rows.used[0]
    for j in range(b.trial.shape[0]):
        s.step[j] = steps * b.trial[j]
    if check_limits(rig, 0, b.shown, True, s) > 0:
        divide_bounds(first, steps, b)
        solve(rig, tolerance, b)


@kernel
def breaks_rows(tolerance: float, braking: Braking) -> bool:
    """Return True for a step that breaks a row by more than the tolerance."""
    s, r = braking.scratch, braking.scratch.rows
    for k in range(r.used[0]):
        if not (along_row(braking.avatars, k, s.step, r.jacobian, r) >= r.bound[k] - tolerance):
            return True
    return False


@kernel
def add_broken(braking_out: Braking) -> int:
    """Add rows for bounds of single degrees and limits of groups that the step breaks; return their number."""
    b, s, r, added = braking_out, braking_out.scratch, braking_out.scratch.rows, 0
    for g in range(b.first.shape[0]):
        first, last = b.first[g], b.last[g]
        if last == first + 1:
            is_below, is_above = s.step[first] < s.low[first] - NOTHING, s.step[first] > s.high[first] + NOTHING
            sign = 1.0 if is_below else -1.0
            if (is_below or is_above) and r.used[0] < r.bound.shape[0] and not has_bound(r, first, sign):
                add_bound(b.avatars, 0, first, sign, s.low[first] if is_below else -s.high[first], r)
                added += 1
        else:
            added += add_ball(first, last, False, b.cap[g], b) + add_ball(first, last, True, b.change[g], b)
    return added


@kernel
def add_ball(first: int, last: int, is_centred: bool, radius: float, braking_out: Braking) -> int:
    """Add a cutting plane where degrees first .. last - 1 of the step leave a ball about zero, or about the last step."""
    b, s, r = braking_out, braking_out.scratch, braking_out.scratch.rows
    square, k = 0.0, r.used[0]
    for j in range(first, last):
        off = s.step[j] - (b.step[j] if is_centred else 0.0)
        square += off * off
    far = square**0.5
    if not (far > radius + NOTHING) or k == r.bound.shape[0]:
        return 0
    r.owner[k, 0], r.owner[k, 1] = 0, -1
    clear_row(b.avatars, k, r)
    bound = -radius
    for j in range(first, last):
        centre = b.step[j] if is_centred else 0.0
        r.jacobian[k, j] = -(s.step[j] - centre) / far
        bound += r.jacobian[k, j] * centre
    r.kind[k], r.pair[k, 0], r.pair[k, 1], r.bound[k], r.multiplier[k] = BUDGET, first, -1, bound, 0.0
    r.used[0] = k + 1
    return 1


@kernel
def keeps_joints(rig: Rig, calls: int, steps: float, braking: Braking) -> bool:
    """Return True if joints stay within limits along the trial's way and turn by less than half a turn."""
    b, x = braking, braking.trial
    for g in range(b.first.shape[0]):
        if b.turning[g] == 1 and steps * length_of(x, b.first[g], b.last[g]) > WIDEST_TURN:
            return False
    for g in range(b.first.shape[0]):
        j = b.first[g]
        if b.last[g] == j + 1:
            end = b.shown.angle[j] + steps * x[j]
            if not (rig.skel.limits[j, 0] - ROUNDING <= end <= rig.skel.limits[j, 1] + ROUNDING):
                return False
    for link in range(rig.skel.kind.shape[0]):
        d = rig.skel.first_dof[link]
        if rig.skel.kind[link] != BALL or not has_cone(rig.skel.balls, link) or length_of(x, d, d + 3) == 0.0:
            continue
        turn = columns(b.shown.turn, link)
        for k in range(calls):
            far = 1.0 + k - k * (k + 1.0) / (2.0 * calls)
            if cone_excess(rig.skel.balls, link, stepped(turn, (far * x[d], far * x[d + 1], far * x[d + 2]))) > ROUNDING:
                return False
    return True


@kernel
def is_certified(rig: Rig, segment_out: MotionSegment, braking: Braking) -> bool:
    """Return True if the trial and the way to rest after it are proved free and within limits."""
    c, b = segment_out, braking
    calls = calls_to_rest(b, b.trial)
    steps = steps_to_rest(calls)
    is_kept = keeps_joints(rig, calls, steps, b)
    copy_posture(rig, 0, b.shown, c.start)
    copy_posture(rig, 0, b.shown, c.end)
    for j in range(b.trial.shape[0]):
        c.part[j] = steps * b.trial[j]
    displace(rig.skel, c.end, c.part)
    share, _, _ = go_along(rig.geo, rig.skel, 0.0, c)
    return is_kept and share >= 1.0


@kernel
def find_step(rig: Rig, margin: float, opening: float, segment_out: MotionSegment, braking_out: Braking) -> bool:
    """Find the trial: a step with a proof; return False if there is none."""
    c, b, tolerance = segment_out, braking_out, SOLVED * margin
    b.pairs.step[0] += 1
    steps = set_caps(most_calls_to_rest(b), b)
    choose_wanted(rig, b)
    set_bounds(rig.skel, steps, b)
    forget_rows(b)
    add_dampers(rig, margin, opening, b.scratch.still, steps, c, b)
    solve_within(rig, tolerance, steps, b)
    if is_certified(rig, c, b):
        return True
    # a step that slows down as the braking does, whose own end is near to that of the braking
    steps = set_caps(max(1, b.calls[0] - 1), b)
    keep_limits(b, b.wanted)
    set_bounds(rig.skel, steps, b)
    forget_rows(b)
    add_dampers(rig, ANEW * margin, opening, b.brake, steps, c, b)
    solve_within(rig, tolerance, steps, b)
    for k in range(len(DRAWN)):
        for j in range(b.trial.shape[0]):
            b.trial[j] = b.brake[j] + DRAWN[k] * (b.trial[j] - b.brake[j])
        if is_certified(rig, c, b):
            return True
    return False


@kernel
def forget_rows(braking_out: Braking) -> None:
    """Begin with no rows."""
    braking_out.scratch.rows.used[0] = 0
    braking_out.scratch.rows.ready[0] = 0


@kernel
def take(rig: Rig, is_found: bool, braking_out: Braking) -> int:
    """Take the trial's posture, or else the braking's, as the shown one; return the outcome."""
    b = braking_out
    b.calls[0] = calls_to_rest(b, b.trial) if is_found else max(b.calls[0] - 1, 0)
    outcome = ARRIVED if is_found else BRAKED
    for j in range(b.step.shape[0]):
        b.step[j] = b.trial[j] if is_found else b.brake[j]
        if is_found and abs(b.error[j] - b.trial[j]) > ROUNDING:
            outcome = STEPPED
    take_step(rig, 0, b.step, b.shown)
    if outcome == ARRIVED:
        copy_posture(rig, 0, b.incoming, b.shown)
    return outcome


@entry_kernel
def rest_at(world: Index, segment: Index, braking: Index, positions: Array, rotations: Array, angles: Array) -> None:
    """Begin at rest at a posture, which has been checked and is free."""
    w, c, b = view_arena(world, WorldParts), view_arena(segment, MotionSegment), view_arena(braking, Braking)
    rig = Rig(w.geometry, w.skeleton, b.avatars)
    read_sample(positions, rotations, angles, c.hinges, b.shown)
    copy_posture(rig, 0, b.shown, b.target)
    b.step[:] = 0.0
    b.calls[0] = 0


@entry_kernel
def step_towards(
    world: Index, segment: Index, braking: Index, positions: Array, rotations: Array, angles: Array, margin: float, opening: float
) -> tuple[int, bool]:
    """Take the step of a call towards a posture, which has been checked; return the outcome, and whether the posture is within
    the limits of joints. `margin` [m] is the gap that pairs keep, `opening` [m] the most that pairs below it open."""
    w, c, b = view_arena(world, WorldParts), view_arena(segment, MotionSegment), view_arena(braking, Braking)
    rig = Rig(w.geometry, w.skeleton, b.avatars)
    read_sample(positions, rotations, angles, c.hinges, c.start)
    clip_avatar(rig, 0, c.start, b.tracking, b.incoming)
    set_brake(b)
    outcome = take(rig, find_step(rig, margin, opening, c, b), b)
    copy_posture(rig, 0, b.incoming, b.target)
    return outcome, b.tracking.is_legal[0] > 0


@entry_kernel
def brake_once(world: Index, braking: Index) -> None:
    """Take the step of a call along the proved way to rest."""
    w, b = view_arena(world, WorldParts), view_arena(braking, Braking)
    rig = Rig(w.geometry, w.skeleton, b.avatars)
    set_brake(b)
    take(rig, False, b)


@entry_kernel
def posture_ahead(
    world: Index, segment: Index, braking: Index, calls: int, positions_out: Array, rotations_out: Array, angles_out: Array
) -> None:
    """Write the posture after so many calls of braking from here."""
    w, c, b = view_arena(world, WorldParts), view_arena(segment, MotionSegment), view_arena(braking, Braking)
    rig = Rig(w.geometry, w.skeleton, b.avatars)
    total = float(max(b.calls[0], 1))
    for j in range(b.step.shape[0]):
        c.part[j] = (calls - calls * (calls + 1.0) / (2.0 * total)) * b.step[j]
    copy_posture(rig, 0, b.shown, c.end)
    displace(rig.skel, c.end, c.part)
    write_sample(c.end, c.hinges, positions_out, rotations_out, angles_out)
