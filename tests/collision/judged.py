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
from avatarsim.collision.warm_query import signed_distance_coherent
from avatarsim.collision.warm_start import make_pair_memory
from avatarsim.model.geometry import ELLIPSOID
from avatarsim.spatial.vec3 import Vec3
from tests.collision.polytopes import greatest_gap, least_distance, outside
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

TURNED = np.array([[0.0, 0.02, -0.01], [-0.02, 0.0, 0.03], [0.01, -0.03, 0.0]])
"""Turn [rad] of the second shape a frame before, for the coherent query; it is shifted by about as much of its size. A memory
may be of anything, so that the turn may be one of first order."""

SCRATCH, STACK, MEMORY = make_scratch(), make_stack(), make_pair_memory(1)

ENUMERATED, BOUNDED, PROVEN, UNPROVED = "enumerated", "bounded", "proved", "undecided"
"""Oracles: all facets or features tried; both bounds from normal and witnesses; no direction is shorter; gave up."""


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


def judge(batch: Batch, k: int, by_qhull: bool = False) -> Verdict:
    """Judge pair k of the batch; `by_qhull` adds the Minkowski difference to the oracles of a polytope pair."""
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
    if not smooth:
        oracle, truth = ENUMERATED, _exact_core_gap(batch, a, b)
        error = max(abs(core - truth), core - proved)
        if not (proved <= truth + 1e-13 * size + rounding):
            lost = lost or f"oracle incomplete by {proved - truth:.2g} m"
        if by_qhull:
            oracle, error = _checked_by_qhull(batch, a, b, truth, core, error)
        low = high = truth - radius_a - radius_b
    elif core > 0.0:
        oracle, apart = BOUNDED, float(np.linalg.norm(core_a - core_b))
        error = max(abs(core - proved), abs(apart + sum(out) - core))
        low, high = proved - radius_a - radius_b, apart + sum(out) - radius_a - radius_b
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
    point: Vec3 = tuple(p.tolist())
    return outside(
        batch.centred, batch.shapes.kind, batch.shapes.start, batch.face, batch.face_start, batch.edge, batch.edge_start, s, point
    )


def _exact_core_gap(batch: Batch, a: int, b: int) -> float:
    """Return the signed distance [m] of polytope cores; if A - B is flat the distance, at least 0."""
    features = batch.centred, batch.shapes.start, batch.face, batch.face_start, batch.edge, batch.edge_start
    gap = greatest_gap(*features, a, b)
    return gap if -np.inf < gap <= 0.0 else least_distance(*features, a, b)


def _smooth_depth(batch: Batch, a: int, b: int, core: float, proved: float, size: float) -> tuple[str, float, float]:
    """Return (oracle, error at most, greatest gap known of any direction) of overlapping cores, one of them an ellipsoid."""
    shapes, tolerance = batch.shapes, 0.2 * RELATIVE * size
    certain, least = proved_depth(
        batch.centred, shapes.kind, shapes.start, a, b, -proved, tolerance, MOST_TRIANGLES, STACK
    )
    # The exact depth is in least - tolerance .. least; the one stated must hold along its own normal, too.
    off = max(abs(-core - least) + tolerance, core - proved)
    return (PROVEN, off, -least) if certain else (UNPROVED, max(-core - least, core - proved), -least)


def _checked_by_qhull(batch: Batch, a: int, b: int, truth: float, core: float, error: float) -> tuple[str, float]:
    rows, start = batch.centred, batch.shapes.start
    if truth > 0.0 or min(start[a + 1] - start[a], start[b + 1] - start[b]) < 1 or start[b + 1] - start[a] < 5:
        return ENUMERATED, error
    differences = (rows[start[a] : start[a + 1], None] - rows[None, start[b] : start[b + 1]]).reshape(-1, 3)
    depth = float(-ConvexHull(differences).equations[:, 3].max())
    return "qhull", max(error, abs(core + depth))


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
    for moved in (True, False):
        warm, wrong = _coherent(batch, k, size, moved)
        difference = max(difference, abs(warm - gap))
        if wrong and back[0] == CONVERGED:
            return difference, wrong
    return difference, ""


def _coherent(batch: Batch, k: int, size: float, moved: bool) -> tuple[float, str]:
    """Return the gap with the memory of b's place a frame before, or as it is left from then, and the answer's fault."""
    a, b, v, shapes = 2 * k, 2 * k + 1, batch.vertices, batch.shapes
    if moved:
        here = slice(shapes.start[b], shapes.start[b + 1])
        kept = v[here].copy()
        arms = kept - kept.mean(axis=0) if shapes.kind[b] != ELLIPSOID else np.vstack([np.zeros(3), kept[1:]])
        v[here] = kept + arms @ TURNED
        v[here if shapes.kind[b] != ELLIPSOID else shapes.start[b]] += TURNED[k % 3] * shapes.extent[b]
        signed_distance_coherent(v, shapes, a, b, np.inf, SCRATCH, MEMORY, 0)
        v[here] = kept
    status, gap, n, on_a, on_b = signed_distance_coherent(v, shapes, a, b, np.inf, SCRATCH, MEMORY, 0)
    unit = np.array(n)
    reach = farthest_of_difference(batch.centred, shapes.kind, shapes.start, a, b, (-n[0], -n[1], -n[2]))
    proved = float(np.array(reach) @ unit - shapes.radius[a] - shapes.radius[b])
    off = max(gap - proved, float(np.abs(np.array(on_a) - np.array(on_b) - gap * unit).max()))
    rounding = ULPS * float(np.spacing(np.abs(v[shapes.start[a] : shapes.start[b + 1]]).max()))
    if status != CONVERGED:
        return gap, f"coherent: status {NAMES[status]}"
    return gap, "" if off <= RELATIVE * size + rounding else f"coherent: normal or points off by {off / size:.2g}"


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


def tally(stratum: str, seed: int, numbers: Iterable[int], pairs: int, every: int = 1) -> Tally:
    """Judge the first `pairs` pairs of some batches; every `every`-th polytope pair that overlaps by qhull as well."""
    found = Tally()
    for number in numbers:
        batch = draw(stratum, seed, number)
        for k in range(min(BATCH, pairs - found.pairs)):
            found.add(judge(batch, k, by_qhull=(number * BATCH + k) % every == 0))
    return found
