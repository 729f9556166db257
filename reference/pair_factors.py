"""One factor per body whose products, or averages, come closest to a table of pairs: for engines that multiply the coefficients
of two bodies, or average them.

Products of three mutually touching bodies can always be exact: r_i = sqrt(e_ij e_ik / e_jk). For more, least
squares of the logarithms, weighted by how likely two bodies meet; where those miss something and any two bodies are as likely
to meet as others, the factors that miss by the least at worst. Averages are least squares with factors of at least 0.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Shape, Sphere
from avatarsim.spatial import rotation
from reference.minimax import least_worst

Array = NDArray[np.float64]

SMALLEST = 1e-6
"""Replaces a coefficient of 0, whose logarithm does not exist."""

NEARBY = 0.3
"""Sideways gap, as a share of the smaller one's half width, at which a pair counts a sixteenth of one that touches: a falling
body meets those below it."""

POINT = 1e-9
"""Half width [m] of bodies without extent: links, which may be anywhere."""

UNLIKELY = 0.01
"""Part of the largest weight of both bodies of a pair below which the pair is left out of the fit: a hundred pairs that never
meet would else bend those that do (restitution 0.88 instead of 1 in `two_spheres`)."""

MISS = 1e-3
"""Difference of a coefficient from which on it counts as another one."""

ALIKE = 0.9
"""Smallest weight over the largest from which on no pair matters more than another. Where some do, the least of the worst
misses is no better: the course of hand_grasp and ball_off_table changes as much as by any other change of a percent."""

RARE = 1e-3
"""Weight, relative to the likeliest pair, below which two bodies hardly ever meet: not reported."""

LISTED = 4
"""Pairs named in full when a rule misses them; the others are counted."""

MAX_BODIES = 60
"""Bodies up to which each has its own factor; above, bodies of one material and role share one (the fit grows
as n^3)."""


@dataclass(frozen=True, eq=False)
class Factors:
    """Factor of each body in canonical order, and the pairs that it does not reproduce: (a, b, wanted, obtained)."""

    values: Array
    misses: tuple[tuple[int, int, float, float], ...]


class _Pairs(NamedTuple):
    """Pairs of bodies that are likely to meet, those of alike bodies counted as one.

    group (n,) of each body; a, b (pairs,) bodies; first, second (m,) groups of each counted pair, its weight and its coefficient.
    """

    group: NDArray[np.int64]
    a: NDArray[np.int64]
    b: NDArray[np.int64]
    first: NDArray[np.int64]
    second: NDArray[np.int64]
    weight: Array
    wanted: Array


def fit(scene: Scene, wanted: Array, matters: Array) -> Factors:
    """Return factors for the symmetric (n, n) coefficients `wanted`, of which an engine takes products; `matters` (n, n) are
    weights, 0 where a pair never meets."""
    if not matters.any():
        return Factors(np.sqrt(np.maximum(np.diag(wanted), 0.0)), ())
    pairs = _pairs(scene, wanted, matters)
    size, target = int(pairs.group.max()) + 1, np.log(np.maximum(pairs.wanted, SMALLEST))
    own = np.zeros(size)
    own[pairs.group] = 0.5 * np.log(np.maximum(np.diag(wanted), SMALLEST))
    logs = np.linalg.lstsq(*_equations(pairs, target, own), rcond=None)[0].astype(np.float64)
    alike = pairs.weight.min() > ALIKE * pairs.weight.max()
    if alike and np.abs(np.exp(logs[pairs.first] + logs[pairs.second]) - np.exp(target)).max() > MISS:
        logs = least_worst(pairs.first, pairs.second, np.exp(target), pairs.weight / pairs.weight.max(), logs)
    values = np.exp(logs)[pairs.group]
    return Factors(values, _misses(pairs, wanted, values[pairs.a] * values[pairs.b]))


def fit_averages(scene: Scene, wanted: Array, matters: Array) -> Factors:
    """Return the same for an engine that takes averages: factors of at least 0, which may be above 1."""
    if not matters.any():
        return Factors(np.diag(wanted).copy(), ())
    pairs = _pairs(scene, wanted, matters)
    own = np.zeros(int(pairs.group.max()) + 1)
    own[pairs.group] = 0.5 * np.diag(wanted)
    # the unknowns are halves of factors, whose sums are the averages
    values = 2.0 * nnls(*_equations(pairs, pairs.wanted, own))[0][pairs.group]
    return Factors(values, _misses(pairs, wanted, 0.5 * (values[pairs.a] + values[pairs.b])))


def _pairs(scene: Scene, wanted: Array, matters: Array) -> _Pairs:
    n = len(scene.names)
    group = np.arange(n)
    if n > MAX_BODIES:
        kinds = list(zip(scene.material_names, scene.roles, strict=True))
        known = sorted(set(kinds), key=lambda kind: (kind[0], kind[1].value))
        group = np.array([known.index(kind) for kind in kinds])
    most = matters.max(axis=1)
    a, b = np.nonzero(np.triu(matters, 1) >= np.maximum(UNLIKELY * np.minimum(most[:, None], most[None]), np.finfo(float).tiny))
    size = int(group.max()) + 1
    keys, inverse = np.unique(np.minimum(group[a], group[b]) * size + np.maximum(group[a], group[b]), return_inverse=True)
    target = np.zeros(len(keys))
    target[inverse] = wanted[a, b]
    weight = np.sqrt(np.bincount(inverse, matters[a, b])).astype(np.float64)
    return _Pairs(group, a, b, keys // size, keys % size, weight, target)


def _equations(pairs: _Pairs, target: Array, own: Array) -> tuple[Array, Array]:
    """Return rows and right sides: the weighted sum of each pair's two unknowns is its `target`, and a trace of pull towards
    `own`, that of each body's material, settles the freedom that the pairs leave (two bodies: one equation)."""
    m, size = len(pairs.first), len(own)
    rows = np.zeros((m + size, size))
    np.add.at(rows, (np.arange(m), pairs.first), pairs.weight)
    np.add.at(rows, (np.arange(m), pairs.second), pairs.weight)
    pull = 1e-6 * pairs.weight.max()
    rows[m:] = pull * np.eye(size)
    return rows, np.concatenate([pairs.weight * target, pull * own])


def _misses(pairs: _Pairs, wanted: Array, obtained: Array) -> tuple[tuple[int, int, float, float], ...]:
    """Return pairs (a, b, wanted, obtained) whose coefficient is another one, the largest difference first."""
    a, b = pairs.a, pairs.b
    off = np.abs(obtained - wanted[a, b]) > MISS
    misses = [(int(i), int(j), float(wanted[i, j]), float(s)) for i, j, s in zip(a[off], b[off], obtained[off], strict=True)]
    return tuple(sorted(misses, key=lambda miss: -abs(miss[2] - miss[3])))


def coefficients(scene: Scene) -> tuple[Array, Array]:
    """Return (n, n) restitution and friction of the scene, without the effects that its author narrowed away."""
    names = scene.material_names
    known = sorted(set(names))
    at = np.array([known.index(name) for name in names])
    pairs = scene.materials.pairs
    table = np.array([[(c.restitution, c.friction) if (c := pairs.get((x, y))) else (0.0, 0.0) for y in known] for x in known])
    restitution, friction = table[np.ix_(at, at)].transpose(2, 0, 1).copy()
    if not scene.effects.restitution:
        restitution[:] = 0.0
    if scene.derived_effects.friction and not scene.effects.friction:
        friction[:] = 0.0
    return restitution, friction


def missed(scene: Scene, averages: bool = False) -> dict[str, str]:
    """Return "restitution" and "friction" -> the values that products, or averages, give to pairs that they miss; without those
    that they reach."""
    features: dict[str, str] = {}
    rule, fitted = ("average", fit_averages) if averages else ("product", fit)
    for what, wanted, matters in zip(("restitution", "friction"), coefficients(scene), weights(scene), strict=True):
        misses = [miss for miss in fitted(scene, wanted, matters).misses if matters[miss[0], miss[1]] > RARE * matters.max()]
        listed = ", ".join(
            f"{scene.names[a]} on {scene.names[b]} {own:.3f} instead of {meant:.3f}" for a, b, meant, own in misses[:LISTED]
        )
        more = f" and {len(misses) - LISTED} more" if len(misses) > LISTED else ""
        if misses:
            features[what] = f"a pair's coefficient is the {rule} of its bodies' factors, here the closest fit: {listed}{more}"
    return features


def weights(scene: Scene) -> tuple[Array, Array]:
    """Return the weight of each pair (n, n) for restitution and for friction."""
    centres, radii = _balls(scene)
    moving = np.array([role is Role.SIMULATED for role in scene.roles])
    driven = np.array([role is Role.DRIVEN for role in scene.roles])
    down = np.array(scene.gravity)
    if np.linalg.norm(down) > 0.0:
        down /= np.linalg.norm(down)
        centres = centres - np.outer(centres @ down, down)
    gap = np.linalg.norm(centres[:, None] - centres[None], axis=2) - radii[:, None] - radii[None]
    smaller = np.maximum(np.minimum(radii[:, None], radii[None]), POINT)
    near = (1.0 / (1.0 + np.maximum(gap, 0.0) / (NEARBY * smaller))) ** 4
    # a driven body may go anywhere
    near = np.where(driven[:, None] | driven[None], 1.0, near)
    bounce = near * scene.contact_filter * (moving[:, None] | moving[None])
    # a driven hand that slides is led by its user: friction there matters, but less
    slide = near * scene.contact_filter * np.where(moving[:, None] | moving[None], 1.0, 0.05)
    return bounce, slide


def _balls(scene: Scene) -> tuple[Array, Array]:
    """Return the centre of the body frame and, sideways, half the width of each body, as seen at the start."""
    centres, radii = np.zeros((len(scene.names), 3)), np.zeros(len(scene.names))
    for k, body in enumerate(scene.bodies):
        centres[k] = body.position
        reach = [np.linalg.norm(rotation.rotate(body.orientation, p.position)) + _width(p.shape) for p in body.pieces]
        radii[k] = max(reach)
    return centres, radii


def _width(shape: Shape) -> float:
    if isinstance(shape, Sphere):
        return shape.radius
    if isinstance(shape, Capsule):
        return shape.radius + 0.5 * shape.length
    if isinstance(shape, Box):
        return 0.5 * max(shape.size)
    if isinstance(shape, Ellipsoid):
        return max(shape.radii)
    return float(np.linalg.norm(shape.vertices, axis=1).max())
