"""Random pairs of convex shapes whose signed distance is known exactly, by which a judge of overlap is itself checked.

Polytopes, balls and capsules by the Minkowski difference of their points, swept by a ball; ellipsoids against a ball or a floor
by closed forms. None of it iterates towards an answer from poses alone, as GJK and EPA do.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Mass, fixed, simulated
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere, ellipsoid_hull
from avatarsim.spatial import rotation
from reference.judging.geometry import rounded_points
from reference.judging.minkowski import signed_distance

Array = NDArray[np.float64]
Random = np.random.Generator
Maker = Callable[[Random], Shape]

SPACING = 20.0
"""Distance [m] between the pairs of one gallery: farther than any two shapes of different pairs could be near."""
REACH = 3.0
"""Boxes [m] apart up to which a pair is measured: every pair of a gallery, and no two shapes of different pairs."""
FLOOR = (4.0, 4.0, 1.0)
"""Sides [m] of the floor under ellipsoids: so large that the way out of it is up."""
LEVEL = 1e-12
"""Metres within which points count as equally far: rounding of coordinates of metres."""
BISECTIONS = 200
"""Halvings of an interval of float64: more than it takes to end at two neighbouring numbers."""


def sphere(random: Random) -> Sphere:
    """Return a ball of 1 to 30 cm."""
    return Sphere(random.uniform(0.01, 0.3))


def box(random: Random) -> Box:
    """Return a box of 2 to 50 cm a side."""
    a, b, c = random.uniform(0.02, 0.5, 3).tolist()
    return Box((a, b, c))


def capsule(random: Random) -> Capsule:
    """Return a capsule from stubby to slender."""
    return Capsule(random.uniform(0.01, 0.1), random.uniform(0.02, 0.5))


def hull(random: Random) -> ConvexHull:
    """Return a polytope with its vertices on an ellipsoid of 2 to 20 cm."""
    a, b, c = random.uniform(0.02, 0.2, 3).tolist()
    return ellipsoid_hull((a, b, c))


def plate(random: Random) -> Box:
    """Return a box up to a thousand times as long as thick: where shallow and deep are close together."""
    length = random.uniform(0.1, 2.0)
    return Box((length, length * random.uniform(0.2, 1.0), length * 10.0 ** random.uniform(-3.0, -1.0)))


def ellipsoid(random: Random) -> Ellipsoid:
    """Return a smooth egg of 3 to 30 cm."""
    a, b, c = random.uniform(0.03, 0.3, 3).tolist()
    return Ellipsoid((a, b, c))


def floor(random: Random) -> Box:
    """Return the one floor."""
    return Box(FLOOR)


def mixed(random: Random) -> Shape:
    """Return any shape that points swept by a ball describe."""
    makers: tuple[Maker, ...] = (sphere, box, capsule, hull, plate)
    return makers[random.integers(len(makers))](random)


KINDS: Mapping[str, tuple[Maker, Maker]] = {
    "balls": (sphere, sphere), "capsules": (capsule, capsule), "boxes": (box, box), "thin plates": (plate, plate),
    "hulls": (hull, hull), "mixed": (mixed, mixed), "ellipsoids and balls": (ellipsoid, sphere),
    "ellipsoids and floors": (ellipsoid, floor),
}
"""Makers of the two shapes of each kind of pair."""

REGIMES = ("apart", "shallow", "at the bound", "deep")
"""Regimes of distance: a gap of 1 nm to 1 mm, at most 1 nm to 1 cm deep, at most 0.5 to 2 um deep, and far inside."""


def support(shape: Shape, turn: Array, direction: Array) -> Array:
    """Return the point (3,) [m] of `shape`, turned by `turn` (3, 3), that lies farthest along the unit `direction` (3,); of
    several, as on a face, the one in their middle."""
    own = direction @ turn
    if isinstance(shape, Ellipsoid):
        radii = np.array(shape.radii)
        return np.asarray(turn @ (radii * radii * own / np.linalg.norm(radii * own)))
    points, radius = rounded_points(shape)
    along = points @ own
    farthest = points[along >= along.max() - LEVEL].mean(axis=0)
    return np.asarray(turn @ farthest + radius * direction)


def offset(regime: str, a: Shape, turn_a: Array, b: Shape, turn_b: Array, toward: Array, random: Random) -> Array:
    """Return the place (3,) [m] of a relative to b at which they meet in the `regime` along the unit direction `toward` (3,)."""
    touching = support(b, turn_b, toward) - support(a, turn_a, -toward)
    if regime == "deep":
        # all shapes are symmetric, so that the origin, and every part of a difference of points, is inside their difference
        return np.asarray(random.uniform(0.0, 0.9) * touching)
    if regime == "apart":
        return np.asarray(touching + 10.0 ** random.uniform(-9.0, -3.0) * toward)
    depth = random.uniform(5e-7, 2e-6) if regime == "at the bound" else 10.0 ** random.uniform(-9.0, -2.0)
    return np.asarray(touching - depth * toward)


def point_to_ellipsoid(point: Array, radii: Array) -> float:
    """Return the signed distance [m] of `point` (3,) from the ellipsoid of half axes `radii` (3,) [m] about the origin.

    The nearest point x of the surface obeys x - p = -t grad / 2, so x_i = r_i^2 p_i / (t + r_i^2), and t is the one root above
    minus the least r_i^2 of sum (r_i p_i / (t + r_i^2))^2 = 1, which falls along there: it is bisected. A point on the plane of
    symmetry across the shortest axis may have no such root; drawn points do not lie there.
    """
    least = float(np.min(radii)) ** 2
    above = radii * radii - least
    scaled = radii * np.abs(point)
    low, high = 0.0, float(np.linalg.norm(scaled)) + least
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if float(((scaled / (middle + above)) ** 2).sum()) > 1.0:
            low = middle
        else:
            high = middle
    t = high - least
    return float(np.sign(t) * np.linalg.norm(t * point / (high + above)))


def exact(a: Shape, turn_a: Array, b: Shape, turn_b: Array, from_b_to_a: Array) -> float:
    """Return the signed distance [m] of two shapes turned by (3, 3), their centres `from_b_to_a` (3,) apart.

    Raises TypeError for an ellipsoid against anything but a ball or the floor: of these no closed form is known.
    """
    if isinstance(a, Ellipsoid):
        radii = np.array(a.radii)
        if isinstance(b, Sphere):
            return point_to_ellipsoid(-from_b_to_a @ turn_a, radii) - b.radius
        if isinstance(b, Box) and b.size == FLOOR:
            up = turn_b[:, 2]
            return float(from_b_to_a @ up - np.linalg.norm(radii * (up @ turn_a)) - 0.5 * FLOOR[2])
        raise TypeError("an ellipsoid has a closed form against a ball and a floor only")
    points_a, radius_a = rounded_points(a)
    points_b, radius_b = rounded_points(b)
    return signed_distance(points_a @ turn_a.T + from_b_to_a, radius_a, points_b @ turn_b.T, radius_b)


@dataclass(frozen=True, eq=False)
class Placed:
    """A gallery placed once: body frames (2n, 3) [m] and (2n, 4), and the exact signed distance (n,) [m] of each pair."""

    positions: Array
    orientations: Array
    exact: Array


class Gallery:
    """n pairs of shapes of one kind, in one scene: pair k is body k and body n + k."""

    def __init__(self, kind: str, pairs: int, random: Random) -> None:
        one, other = KINDS[kind]
        self.shapes = tuple((one(random), other(random)) for _ in range(pairs))
        bodies = [simulated(f"a{k}", (Piece(a),), "wood", Mass(1.0)) for k, (a, _) in enumerate(self.shapes)]
        bodies += [fixed(f"b{k}", (Piece(b),), "wood") for k, (_, b) in enumerate(self.shapes)]
        self.scene = Scene("gallery", tuple(bodies))

    def placed(self, regime: str, random: Random) -> Placed:
        """Return all pairs turned at random and brought together in a regime."""
        n = len(self.shapes)
        orientations = rotation.normalised(random.normal(size=(2 * n, 4)))
        turns = rotation.to_matrix(orientations)
        at_b = np.arange(n)[:, None] * np.array([SPACING, 0.0, 0.0])
        at_a = at_b.copy()
        for k, (a, b) in enumerate(self.shapes):
            at_a[k] += offset(regime, a, turns[k], b, turns[n + k], _toward(b, turns[n + k], random), random)
        # the judge's input carries the rounding of the place, and so does the exact answer
        distances = [exact(a, turns[k], b, turns[n + k], at_a[k] - at_b[k]) for k, (a, b) in enumerate(self.shapes)]
        return Placed(np.concatenate([at_a, at_b]), orientations, np.array(distances))


def _toward(b: Shape, turn_b: Array, random: Random) -> Array:
    """Return a direction (3,) out of b: of a box every other time a face's own, since furniture makes contact by faces."""
    if isinstance(b, Box) and (b.size == FLOOR or random.integers(2)):
        axis = 2 if b.size == FLOOR else int(random.integers(3))
        return np.asarray(turn_b[:, axis])
    toward = random.normal(size=3)
    return np.asarray(toward / np.linalg.norm(toward))
