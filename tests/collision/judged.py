"""Batches of pairs put to the query, and its answers judged by oracles that share no code with it."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance, signed_distance_up_to
from avatarsim.collision.status import CONVERGED, NAMES
from avatarsim.model.geometry import ELLIPSOID
from avatarsim.spatial import rotation
from avatarsim.spatial.vec3 import Vec3
from reference.judging.segments import point_segment_distance, triangle_distance
from tests.collision.proved_depth import farthest_of_difference, make_stack, proved_depth
from tests.collision.strata import BATCH, Batch, draw

Array = NDArray[np.float64]

RELATIVE = 1e-9
"""The bar: depth and distance to this fraction of the shape's size."""
SIGN_BAND = 1e-12
"""Relative to size: of a gap nearer zero than this either sign is right; both oracle and query round at 1e-16 of every
coordinate, and the query's own tolerance for a polytope is this."""
SMOOTH_SIGN_BAND = 1e-9
"""The same for ellipsoids: a surface that facets only approach."""
ULPS = 8
"""Units in the last place of the largest coordinate [m] by which an answer may be off on top: the precision of the
coordinates themselves. 1e5 m from the origin that is 1.2e-10 m, and it exceeds RELATIVE for shapes below 0.12 m."""
MOST_TRIANGLES = 300_000
"""Effort for one proof of a depth: typical are 200 to 5,000; only where nearly every direction is equally deep, as in two
concentric balls written as ellipsoids, it ends undecided."""

SCRATCH, STACK = make_scratch(), make_stack()

QHULL, BOUNDED, PROVEN, UNPROVED = "qhull", "bounded", "proved", "undecided"
"""Oracles: all facets of the Minkowski difference; both bounds from normal and witnesses; no direction is shorter; gave up."""


@dataclass(frozen=True)
class Verdict:
    """One pair judged; lengths are relative to the size of the larger shape, beyond the rounding of coordinates."""

    label: str
    status: int
    oracle: str
    error: float
    """Of the gap; for a proved depth at most this."""
    witness: float
    """By how much the points miss the shapes, or miss being gap n apart."""
    swapped: float
    """Difference of the gap with a and b exchanged, with a margin, and with the memory of a frame before, from this one."""
    wrong_sign: bool
    lost: str
    """Faults besides figures; empty: none."""

    @property
    def failures(self) -> list[str]:
        """Why the pair fails; empty if it does not."""
        found = [self.lost] if self.lost else []
        if self.status != CONVERGED and self.oracle != UNPROVED:
            found.append(f"status {NAMES[self.status]}")
        for name, value in (("error", self.error), ("witness", self.witness), ("swapped", self.swapped)):
            if not (value <= RELATIVE):
                found.append(f"{name} {value:.2g}")
        return [*found, *(["wrong sign"] if self.wrong_sign else [])]


def judge(batch: Batch, k: int) -> Verdict:
    """Judge pair k of the batch."""
    a, b, shapes = 2 * k, 2 * k + 1, batch.shapes
    seed: Vec3 = tuple(batch.seed[k].tolist())
    size = float(max(shapes.extent[a], shapes.extent[b]))
    rounding = ULPS * float(np.spacing(np.abs(batch.vertices[shapes.start[a] : shapes.start[b + 1]]).max()))
    status, gap, n, on_a, on_b = signed_distance(batch.vertices, shapes, a, b, seed, SCRATCH)
    if not np.isfinite([gap, *n, *on_a, *on_b]).all():
        return Verdict(batch.label[k], status, UNPROVED, np.inf, np.inf, np.inf, True, "not finite")

    def relative(length: float) -> float:
        return max(0.0, abs(length) - rounding) / size

    radius_a, radius_b = float(shapes.radius[a]), float(shapes.radius[b])
    core, unit = gap + radius_a + radius_b, np.array(n)
    core_a = np.array(on_a) - batch.centre[k] + radius_a * unit
    core_b = np.array(on_b) - batch.centre[k] - radius_b * unit
    out = [_outside(batch, s, p) for s, p in ((a, core_a), (b, core_b))]
    away = (-n[0], -n[1], -n[2])
    reach = farthest_of_difference(batch.centred, shapes.kind, shapes.start, a, b, away)
    proved = float(np.array(reach) @ unit)
    lost = "" if abs(np.linalg.norm(unit) - 1.0) < 1e-12 else "normal is no unit vector"
    smooth = ELLIPSOID in (shapes.kind[a], shapes.kind[b])
    band = (SMOOTH_SIGN_BAND if smooth else SIGN_BAND) * size + rounding
    if core > 0.0 or _is_flat(batch, a, b):
        # at least what the normal proves, at most how far two points of the cores are from each other
        oracle, apart = BOUNDED, float(np.linalg.norm(core_a - core_b))
        error = max(abs(core - proved), abs(apart + sum(out) - core))
        low, high = proved - radius_a - radius_b, apart + sum(out) - radius_a - radius_b
    elif not smooth:
        oracle, truth = QHULL, _core_depth(batch, a, b)
        error = max(abs(core + truth), core - proved)
        low = high = -truth - radius_a - radius_b
    else:
        oracle, error, low = _smooth_depth(batch, a, b, core, proved, size)
        low, high = low - radius_a - radius_b, gap + error
    witness = max(float(np.linalg.norm(core_a - core_b - core * unit)), *out)
    wrong = (gap > 0.0 and high < -band) or (not gap > 0.0 and low > band)
    swapped, doors = _other_doors(batch, k, gap, seed, size, rounding, smooth)
    return Verdict(
        batch.label[k], status, oracle, relative(error), relative(witness), relative(swapped), bool(wrong), lost or doors
    )


def _outside(batch: Batch, s: int, p: Array) -> float:
    """Return the distance [m] of p from the core of shape s, 0 inside; for an ellipsoid at least that."""
    rows = batch.centred[batch.shapes.start[s] : batch.shapes.start[s + 1]]
    if batch.shapes.kind[s] == ELLIPSOID:
        return _outside_ellipsoid(rows[0], rows[1:], p)
    faces = batch.face[batch.face_start[s] : batch.face_start[s + 1]]
    if not len(faces):
        return float(point_segment_distance(p, rows[0], rows[-1]))
    a, b, c = rows[faces].swapaxes(0, 1)
    beyond = (rotation.cross(b - a, c - a) * (p - a)).sum(axis=1).max() > 0.0
    return float(triangle_distance(p, a, b, c).min()) if beyond else 0.0


def _outside_ellipsoid(centre: Array, axes: Array, p: Array) -> float:
    """Distance of p from some point of the ellipsoid, 0 inside: at least the true distance, and nearly it when that is small."""
    squares = (axes * axes).sum(axis=1)
    shares = axes @ (p - centre) / squares
    length = float(np.linalg.norm(shares))
    if length <= 1.0:
        return 0.0
    gradient = (shares / squares) @ axes / length
    # A little more than the linear step, to arrive inside; if none does, the point towards the centre is inside.
    step = 1.001 * (length - 1.0) / float(gradient @ gradient)
    for _ in range(8):
        if np.linalg.norm(axes @ (p - step * gradient - centre) / squares) <= 1.0:
            return step * float(np.linalg.norm(gradient))
        step *= 1.2
    return float(np.linalg.norm(p - centre)) * (1.0 - 1.0 / length)


def _smooth_depth(batch: Batch, a: int, b: int, core: float, proved: float, size: float) -> tuple[str, float, float]:
    """Return (oracle, error at most, greatest gap known of any direction) of overlapping cores, one of them an ellipsoid."""
    shapes, tolerance = batch.shapes, 0.2 * RELATIVE * size
    certain, least = proved_depth(
        batch.centred, shapes.kind, shapes.start, a, b, -proved, tolerance, MOST_TRIANGLES, STACK
    )
    # The exact depth is in least - tolerance .. least; the one stated must hold along its own normal, too.
    off = max(abs(-core - least) + tolerance, core - proved)
    return (PROVEN, off, -least) if certain else (UNPROVED, max(-core - least, core - proved), -least)


def _is_flat(batch: Batch, a: int, b: int) -> bool:
    """Return whether A - B of the cores is a point, a segment or a parallelogram: neither has a face, or a volume."""
    smooth = ELLIPSOID in (batch.shapes.kind[a], batch.shapes.kind[b])
    return not smooth and all(batch.face_start[s] == batch.face_start[s + 1] for s in (a, b))


def _core_depth(batch: Batch, a: int, b: int) -> float:
    """Return the depth [m] of two polytope cores from qhull's facets of their Minkowski difference; negative: apart."""
    rows, start = batch.centred, batch.shapes.start
    differences = rows[start[a] : start[a + 1], None] - rows[None, start[b] : start[b + 1]]
    return float(-ConvexHull(differences.reshape(-1, 3)).equations[:, 3].max())


def _other_doors(
    batch: Batch, k: int, gap: float, seed: Vec3, size: float, rounding: float, smooth: bool
) -> tuple[float, str]:
    """Return the difference after exchanging a and b; and whether the queries with a margin contradict the full one."""
    a, b, v, shapes = 2 * k, 2 * k + 1, batch.vertices, batch.shapes
    back = signed_distance(v, shapes, b, a, (-seed[0], -seed[1], -seed[2]), SCRATCH)
    difference = abs(back[1] - gap)
    slack = (SMOOTH_SIGN_BAND if smooth else SIGN_BAND) * size + rounding
    for margin in (0.0, 0.5 * abs(gap), gap + 10.0 * slack):
        margin = max(margin, 0.0)
        status, bound, *_ = signed_distance_up_to(v, shapes, a, b, seed, margin, SCRATCH)
        if status != CONVERGED and back[0] == CONVERGED:
            return difference, f"with margin: status {NAMES[status]}"
        if bound > margin and not (bound <= gap + slack):
            return difference, f"bound {bound:.17g} proved beyond the gap {gap:.17g}"
        if not bound > margin:
            difference = max(difference, abs(bound - gap))
        if (bound > margin) != (gap > margin) and abs(gap - margin) > slack:
            return difference, f"with margin {margin:.3g} the bound is {bound:.17g}, the gap {gap:.17g}"
    return difference, ""


@dataclass
class Tally:
    """Counts and worst figures (relative to size) of the pairs of one stratum."""

    pairs: int = 0
    error: float = 0.0
    witness: float = 0.0
    swapped: float = 0.0
    wrong_signs: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    oracles: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)

    def add(self, verdict: Verdict) -> None:
        """Count one pair."""
        self.pairs += 1
        self.error = max(self.error, verdict.error)
        self.witness = max(self.witness, verdict.witness)
        self.swapped = max(self.swapped, verdict.swapped)
        self.wrong_signs += verdict.wrong_sign
        self.oracles[verdict.oracle] += 1
        if verdict.status != CONVERGED:
            self.statuses[NAMES[verdict.status]] += 1
        if verdict.failures:
            self.failures.append(f"{verdict.label}: {', '.join(verdict.failures)}")

    def join(self, other: "Tally") -> None:
        """Add the counts of another process."""
        self.pairs += other.pairs
        self.error, self.witness = max(self.error, other.error), max(self.witness, other.witness)
        self.swapped = max(self.swapped, other.swapped)
        self.wrong_signs += other.wrong_signs
        self.statuses += other.statuses
        self.oracles += other.oracles
        self.failures += other.failures


def tally(stratum: str, seed: int, numbers: Iterable[int], pairs: int) -> Tally:
    """Judge the first `pairs` pairs of some batches."""
    found = Tally()
    for number in numbers:
        batch = draw(stratum, seed, number)
        for k in range(min(BATCH, pairs - found.pairs)):
            found.add(judge(batch, k))
    return found
