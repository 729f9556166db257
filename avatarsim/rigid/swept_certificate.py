"""Certificate of a substep: proof that a pair of pieces stays apart while both bodies turn at a constant rate and fly.

The height of a vertex along a direction differs from its chord by at most t^2/8 times the largest second derivative. So if one
direction separates both ends by more than these bulges it separates all that is between. The direction is fixed in the world, or
carried by either body (then that body's vertices do not bulge). Where none is found the motion is cut in parts (bisection).

A pair that is nearer than that at the start, as those of the exact path are, may dip as these do; to stand still is certified.
Gaps of a pair that overlaps at home are those beyond the depth that it may have.
"""

from math import atan2
from typing import NamedTuple

from avatarsim.collision.conservative_advancement import DIP
from avatarsim.collision.path import acceleration, spun
from avatarsim.collision.signed_distance import signed_distance_up_to
from avatarsim.collision.support import gap_along
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Geometry, Poses, allowed_depth, place
from avatarsim.rigid.state import QUERY_WORK, WORK, Memory
from avatarsim.rigid.substep_state import KNOWN
from avatarsim.spatial.tangent import columns, put_columns, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, norm, put_row, row, sub
from avatarsim.tolerances import FINE, JUDGED, PROOF

LEAST = FINE * JUDGED
"""[m] gap that is proved. Nearer to 0: rounding of a pose may show as an overlap; larger: wedged bodies are refused."""

PARTS, SHORTEST = 80, 2e-3
"""Most parts of a cut motion, and the shortest, as a share of the substep. Fewer or longer parts: motions that are free are
refused; more: a refused pair takes longer."""

SAGITTA = 0.125
"""Factor of t^2 times the largest second derivative in the distance of a height from its chord."""

NOWHERE = (0.0, 0.0, 0.0)


@kernel
def least_of(gap: float) -> float:
    """Return the gap [m] that is to be proved for a pair with this gap at the start. Bodies of the exact path are STAND_OFF apart
    or have dipped to DIP: they may dip so deep here too, or stand still."""
    return LEAST if gap >= 2.0 * LEAST else min(DIP, gap - PROOF)


class Refusal(NamedTuple):
    """Result of a certificate: whether it holds; else the share of the motion where the pair is nearest, and there its gap [m],
    direction out of B into A and closest points. A share below 1 leaves that pose in `Substeps.high`."""

    holds: bool
    at: float
    gap: float
    normal: Vec3
    on_a: Vec3
    on_b: Vec3


@kernel
def pose_at(geometry: Geometry, poses: Poses, memory: Memory, b: int, t: float, out: Poses) -> None:
    """Put body b of ``out`` at its pose t seconds into the substep that begins at ``poses``."""
    sub_, a = memory.substeps, acceleration(memory.paths, b)
    x = along(row(poses.position, b), t, row(sub_.velocity, b))
    put_row(out.position, b, along(x, 0.5 * t * t, a))
    put_columns(out.rotation, b, spun(columns(poses.rotation, b), row(sub_.turning, b), t))
    place(geometry, out, b)


@kernel
def measure_motion(geometry: Geometry, poses: Poses, memory: Memory, b: int, h: float) -> None:
    """Fill ``turn`` of body b for its motion of h seconds, and ``bulge``: how far points leave their chords because it turns."""
    sub_, w = memory.substeps, row(memory.substeps.turning, b)
    sub_.turn[b] = norm(w) * h
    far = 0.0
    if sub_.turn[b] > 0.0:
        # points on the axis of rotation do not bulge
        in_body = turned_back(columns(poses.rotation, b), w)
        for s in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
            if geometry.shapes.kind[s] != POINTS:
                far = max(far, norm(w) * memory.reach[b])
                continue
            for i in range(geometry.shapes.start[s], geometry.shapes.start[s + 1]):
                far = max(far, norm(cross(in_body, row(geometry.local, i))))
    sub_.bulge[b] = SAGITTA * h * far * sub_.turn[b]


@kernel
def boxes_stay_apart(start: Poses, end: Poses, i: int, k: int, room: float) -> bool:
    """Return whether one axis of the world separates the boxes of two pieces by more than ``room`` [m] at both ends."""
    a, b = start.boxes, end.boxes
    for x in range(3):
        if a[i, x] - a[k, 3 + x] > room and b[i, x] - b[k, 3 + x] > room:
            return True
        if a[k, x] - a[i, 3 + x] > room and b[k, x] - b[i, 3 + x] > room:
            return True
    return False


@kernel
def least_between(before: float, after: float, bulge: float) -> float:
    """Return the least of before + (after - before) s - 4 bulge s (1 - s) for s in 0 .. 1: a lower bound of the gap between."""
    rise = after - before
    if not (bulge > 0.0) or abs(rise) >= 4.0 * bulge:
        return min(before, after)
    s = 0.5 - rise / (8.0 * bulge)
    return before + rise * s - 4.0 * bulge * s * (1.0 - s)


@kernel
def bulge_of_carried(memory: Memory, start: Poses, end: Poses, carrier: int, other: int, h: float, share: float) -> float:
    """Return how far [m] core points of body ``other`` leave their chords along a direction that turns with ``carrier``, over a
    share of the substep of h seconds.

    With n' = w x n the height n . (d + r) has the second derivative n'' . d + 2 n' . d' + n . d'' and that of a vector r that
    turns at both rates.
    """
    sub_ = memory.substeps
    t, both = share * sub_.turn[carrier], share * (sub_.turn[carrier] + sub_.turn[other])
    before = sub(row(start.position, carrier), row(start.position, other))
    moved = norm(sub(sub(row(end.position, carrier), row(end.position, other)), before))
    gain = (share * h) ** 2 * norm(sub(acceleration(memory.paths, carrier), acceleration(memory.paths, other)))
    bulge = both * both * memory.reach[other] + t * t * (norm(before) + moved + gain) + 2.0 * t * (moved + gain) + gain
    return SAGITTA * float(bulge)


@kernel
def stays_apart(
    memory: Memory, start: Poses, end: Poses, a: int, b: int, n: Vec3, gap: float, n_then: Vec3, gap_then: float,
    h: float, share: float, least: float,
) -> bool:
    """Return whether the direction that turns evenly from n to ``n_then`` proves ``least`` [m] from start to end.

    gap, gap_then: along them, at both ends. Both ends are a share of the substep of h seconds apart. This is the direction that
    two crossed edges need: it turns with both of them, and the heights along any other leave the gap at once.
    """
    sub_ = memory.substeps
    turn = atan2(norm(cross(n, n_then)), dot(n, n_then))
    before = sub(row(start.position, a), row(start.position, b))
    moved = norm(sub(sub(row(end.position, a), row(end.position, b)), before))
    gain = (share * h) ** 2 * norm(sub(acceleration(memory.paths, a), acceleration(memory.paths, b)))
    turn_a, turn_b = share * sub_.turn[a], share * sub_.turn[b]
    far = norm(before) + moved + memory.reach[a] + memory.reach[b]
    faster = moved + gain + turn_a * memory.reach[a] + turn_b * memory.reach[b]
    bulge = turn * turn * far + 2.0 * turn * faster + turn_a * turn_a * memory.reach[a] + turn_b * turn_b * memory.reach[b] + gain
    return least_between(gap, gap_then, SAGITTA * bulge) >= least


@kernel
def separates(
    geometry: Geometry, start: Poses, end: Poses, memory: Memory, sa: int, sb: int, n: Vec3, h: float, share: float, least: float
) -> bool:
    """Return whether direction n, given at ``start``, keeps the pieces at least ``least`` [m] apart from start to end.

    Both ends are a share of the substep of h seconds apart. The direction is fixed in the world, or carried by either body.
    """
    sub_, a, b = memory.substeps, geometry.body[sa], geometry.body[sb]
    depth = allowed_depth(geometry, sa, sb)
    before = gap_along(start.vertices, geometry.shapes, sa, sb, n) + depth
    if not (before >= least):
        return False
    after = gap_along(end.vertices, geometry.shapes, sa, sb, n) + depth
    if after >= least:
        # a gap that is accelerated apart lies below its chord
        apart = dot(n, sub(acceleration(memory.paths, a), acceleration(memory.paths, b)))
        bulge = share * share * (sub_.bulge[a] + sub_.bulge[b] + SAGITTA * h * h * max(0.0, apart))
        if least_between(before, after, bulge) >= least:
            return True
    for side in range(2):
        carrier, other = (a, b) if side == 0 else (b, a)
        if sub_.turn[carrier] == 0.0:
            continue
        carried = turned(columns(end.rotation, carrier), turned_back(columns(start.rotation, carrier), n))
        after = gap_along(end.vertices, geometry.shapes, sa, sb, carried) + depth
        if after >= least:
            bulge = bulge_of_carried(memory, start, end, carrier, other, h, share)
            if least_between(before, after, bulge) >= least:
                return True
    return False


@kernel
def query(geometry: Geometry, poses: Poses, memory: Memory, sa: int, sb: int, margin: float) -> tuple[float, Vec3, Vec3, Vec3]:
    """Return the gap [m], exact below ``margin``, direction and closest points of two pieces."""
    memory.counts[WORK] += QUERY_WORK
    _, gap, n, on_a, on_b = signed_distance_up_to(poses.vertices, geometry.shapes, sa, sb, NOWHERE, margin, memory.scratch)
    return gap + allowed_depth(geometry, sa, sb), n, on_a, on_b


@kernel
def speed_bound(memory: Memory, a: int, b: int, h: float) -> float:
    """Return the largest rate [m/s] at which the gap of bodies a and b can change in this substep."""
    sub_, gain = memory.substeps, sub(acceleration(memory.paths, a), acceleration(memory.paths, b))
    turning = norm(row(sub_.turning, a)) * memory.reach[a] + norm(row(sub_.turning, b)) * memory.reach[b]
    return float(norm(sub(row(sub_.velocity, a), row(sub_.velocity, b))) + h * norm(gain) + turning)


@kernel
def proved_by_parts(
    geometry: Geometry, poses: Poses, memory: Memory, sa: int, sb: int, n: Vec3, gap: float, h: float, least: float
) -> Refusal:
    """Return the certificate of a pair by parts of its motion, each proved by a direction, or by a gap larger than the motion.

    n, gap: at the start. Parts are halved where the proof fails, down to SHORTEST.
    """
    low, high, a, b = memory.substeps.low, memory.substeps.high, geometry.body[sa], geometry.body[sb]
    done, part, rate = 0.0, 0.5, h * speed_bound(memory, a, b, h)
    pose_at(geometry, poses, memory, a, 0.0, low)
    pose_at(geometry, poses, memory, b, 0.0, low)
    worst = Refusal(False, 1.0, 1e300, n, NOWHERE, NOWHERE)
    for _ in range(PARTS):
        until = min(1.0, done + part)
        pose_at(geometry, poses, memory, a, until * h, high)
        pose_at(geometry, poses, memory, b, until * h, high)
        holds = gap - (until - done) * rate >= least or separates(
            geometry, low, high, memory, sa, sb, n, h, until - done, least
        )
        gap_then, n_then, on_a, on_b = query(geometry, high, memory, sa, sb, 1.0)
        if not holds and gap_then >= least:
            holds = stays_apart(
                memory, low, high, a, b, n, gap, n_then, gap_then, h, until - done, least
            ) or separates(geometry, high, low, memory, sa, sb, n_then, h, until - done, least)
        # beyond the middle of the other piece the direction out of it is the wrong one
        if gap_then < worst.gap and dot(n_then, n) > 0.0:
            worst = Refusal(False, until, gap_then, n_then, on_a, on_b)
        if holds:
            if until >= 1.0:
                return Refusal(True, 1.0, gap_then, n_then, on_a, on_b)
            done, n, gap, part = until, n_then, gap_then, 1.5 * part
            pose_at(geometry, poses, memory, a, done * h, low)
            pose_at(geometry, poses, memory, b, done * h, low)
        else:
            part *= 0.5
            if not (gap_then >= least) or part < SHORTEST:
                break
    if worst.gap == 1e300:
        gap_then, n_then, on_a, on_b = query(geometry, low, memory, sa, sb, 1.0)
        worst = Refusal(False, max(done, SHORTEST), gap_then, n_then, on_a, on_b)
    pose_at(geometry, poses, memory, a, worst.at * h, high)
    pose_at(geometry, poses, memory, b, worst.at * h, high)
    return worst


@kernel
def certify_pieces(geometry: Geometry, poses: Poses, memory: Memory, q: int, h: float) -> Refusal:
    """Return the certificate of near pair q of pieces from ``poses`` to `Memory.trial`, h seconds later."""
    sub_, trial = memory.substeps, memory.trial
    sa, sb = sub_.pieces[q, 0], sub_.pieces[q, 1]
    a, b = geometry.body[sa], geometry.body[sb]
    free = Refusal(True, 1.0, 0.0, NOWHERE, NOWHERE, NOWHERE)
    gain = SAGITTA * h * h * norm(sub(acceleration(memory.paths, a), acceleration(memory.paths, b)))
    if boxes_stay_apart(poses, trial, sa, sb, LEAST + sub_.bulge[a] + sub_.bulge[b] + gain):
        return free
    if sub_.state[q] != KNOWN:
        gap, n, _, _ = query(geometry, poses, memory, sa, sb, 1.0)
        put_row(sub_.normal, q, n)
        sub_.gap[q], sub_.state[q] = gap, KNOWN
    gap, n = sub_.gap[q], row(sub_.normal, q)
    least = least_of(gap)
    if separates(geometry, poses, trial, memory, sa, sb, n, h, 1.0, least):
        return free
    gap_then, n_then, on_a, on_b = query(geometry, trial, memory, sa, sb, 1.0)
    if gap_then >= least:
        if stays_apart(memory, poses, trial, a, b, n, gap, n_then, gap_then, h, 1.0, least) or separates(
            geometry, trial, poses, memory, sa, sb, n_then, h, 1.0, least
        ):
            return free
    elif dot(n_then, n) > 0.0:
        return Refusal(False, 1.0, gap_then, n_then, on_a, on_b)
    return proved_by_parts(geometry, poses, memory, sa, sb, n, gap, h, least)
