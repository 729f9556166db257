"""Independent check of overlap by the library coal (Pan et al., https://github.com/coal-library/coal), which shares no code with
avatarsim.

It is given the shapes and the poses of links as `poses_of_links` has them, in every frame and at ten equal steps between. Where
the package is missing a note reports it, and nothing else changes.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.cleaning.result import OVERLAP, Opinion
from avatarsim.model.geometry import CORNERS
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Shape, Sphere
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

BETWEEN = 10
"""Equal steps from one frame to the next that are checked."""

AT_ONCE = 256
"""States that are placed in one batch; more: memory for the boxes of all of them."""

TOLERANCE, FACES = 1e-9, 512
"""Tolerance [m] of coal's iterations, and most faces that it may open: at its defaults curved shapes are off by micrometres."""


def opinion_of(scene: Scene, motion: Motion) -> tuple[Opinion | None, str]:
    """Return coal's result for a motion of the scene's avatar; or None, and the reason."""
    try:
        import coal  # noqa: F401
    except ImportError:
        return None, "no second opinion: the package coal is not installed (pip install 'avatarsim[compare]')"
    coal_scene = CoalScene(scene)
    frames = coal_scene.depths(motion)
    finer = coal_scene.depths(between_frames(motion)) if len(motion) > 1 else np.zeros(0)
    return Opinion(
        "coal", len(frames), int(np.sum(~(frames <= OVERLAP))), float(frames.max()), len(finer), int(np.sum(~(finer <= OVERLAP))),
        float(finer.max(initial=0.0)),
    ), ""


def between_frames(motion: Motion) -> Motion:
    """Return the postures at the inner ones of BETWEEN equal steps from each frame to the next."""
    steps = len(motion) - 1
    share = np.tile(np.arange(1, BETWEEN) / BETWEEN, steps)

    def ends(values: Array) -> tuple[Array, Array]:
        return np.repeat(values[:-1], BETWEEN - 1, axis=0), np.repeat(values[1:], BETWEEN - 1, axis=0)

    def on_line(values: Array) -> Array:
        before, after = ends(values)
        return np.asarray(before + share.reshape(-1, *(1,) * (values.ndim - 1)) * (after - before))

    shares = np.repeat(share[:, None], motion.rotations.shape[1], axis=1)
    turned = rotation.normalised(rotation.slerp(*ends(motion.rotations), shares))
    return Motion(on_line(motion.times), on_line(motion.positions), turned, on_line(motion.angles))


class CoalScene:
    """The pieces of a scene as coal objects."""

    def __init__(self, scene: Scene) -> None:
        import coal

        self.scene = scene
        groups = [*(body.pieces for body in scene.bodies), *(link.pieces for link in scene.links)]
        owned = [(k, piece) for k, pieces in enumerate(groups) for piece in pieces]
        self.owner = np.array([k for k, _ in owned], dtype=np.int64)
        self.place = np.array([piece.position for _, piece in owned])
        self.turn = np.array([piece.orientation for _, piece in owned])
        self.shapes = [coal_shape(piece.shape) for _, piece in owned]
        self.half = np.array([half_box(piece.shape) for _, piece in owned])
        self.placed = [coal.Transform3s() for _ in owned]
        first = len(scene.bodies)
        wanted = np.triu(scene.pair_filter[self.owner[:, None], self.owner[None, :]], 1)
        # every checked pair has a link in it, and links come last
        one, other = np.nonzero(wanted)
        self.pairs = np.stack([one, other], axis=1)[self.owner[other] >= first]
        allowed = np.zeros(scene.pair_filter.shape)
        for a, b, depth in scene.resting:
            allowed[a, b] = allowed[b, a] = depth
        self.allowed = allowed[self.owner[self.pairs[:, 0]], self.owner[self.pairs[:, 1]]]
        self.request = coal.DistanceRequest()
        self.request.enable_signed_distance = True
        self.request.gjk_tolerance = self.request.epa_tolerance = TOLERANCE
        self.request.epa_max_iterations = FACES

    def depths(self, motion: Motion) -> Array:
        """Return the deepest overlap (F,) [m] of each posture, for pairs that overlap at home beyond that; 0 for none."""
        found = np.zeros(len(motion))
        for start in range(0, len(motion), AT_ONCE):
            some = slice(start, start + AT_ONCE)
            found[some] = self._block(motion.positions[some], motion.rotations[some], motion.angles[some])
        return found

    def _block(self, roots: Array, rotations: Array, angles: Array) -> Array:
        import coal

        positions, turns = self._pieces(*poses_of_links(self.scene.avatars, roots, rotations, angles))
        reach = np.einsum("fpij,pj->fpi", np.abs(turns), self.half[:, :3]) + self.half[:, 3:]
        low, high = positions - reach, positions + reach
        a, b = self.pairs[:, 0], self.pairs[:, 1]
        near = ((low[:, a] <= high[:, b]) & (low[:, b] <= high[:, a])).all(axis=2)
        depths, result, shown = np.zeros(len(roots)), coal.DistanceResult(), np.full(len(self.shapes), -1)
        for k, pair in zip(*(column.tolist() for column in np.nonzero(near)), strict=True):
            i, j = self.pairs[pair].tolist()
            for piece in (i, j):
                if shown[piece] != k:
                    self.placed[piece].setTransform(turns[k, piece], positions[k, piece])
                    shown[piece] = k
            result.clear()
            gap = coal.distance(self.shapes[i], self.placed[i], self.shapes[j], self.placed[j], self.request, result)
            depths[k] = max(depths[k], -gap - self.allowed[pair])
        return depths

    def _pieces(self, links: Array, link_turns: Array) -> tuple[Array, Array]:
        """Return positions (F, p, 3) and rotation matrices (F, p, 3, 3) of all pieces."""
        frames, bodies = len(links), self.scene.bodies
        stand = np.array([body.position for body in bodies]).reshape(-1, 3)
        lie = np.array([body.orientation for body in bodies]).reshape(-1, 4)
        at = np.concatenate([np.broadcast_to(stand, (frames, *stand.shape)), links], axis=1)[:, self.owner]
        turned = np.concatenate([np.broadcast_to(lie, (frames, *lie.shape)), link_turns], axis=1)[:, self.owner]
        places = np.broadcast_to(self.place, at.shape)
        return at + rotation.rotate(turned, places), rotation.to_matrix(rotation.multiply(turned, self.turn))


def half_box(shape: Shape) -> tuple[float, float, float, float, float, float]:
    """Return half lengths of the box around a shape's core in its own frame, and the margin in all directions [m]."""
    if isinstance(shape, Sphere):
        return (0.0, 0.0, 0.0, *(shape.radius,) * 3)
    if isinstance(shape, Capsule):
        return (0.0, 0.0, 0.5 * shape.length, *(shape.radius,) * 3)
    if isinstance(shape, Box):
        x, y, z = shape.size
        return (0.5 * x, 0.5 * y, 0.5 * z, 0.0, 0.0, 0.0)
    if isinstance(shape, Ellipsoid):
        return (*shape.radii, 0.0, 0.0, 0.0)
    x, y, z = np.abs(shape.vertices).max(axis=0).tolist()
    return (x, y, z, 0.0, 0.0, 0.0)


def coal_shape(shape: Shape) -> Any:
    """Convert a shape to coal's type, boxes as hulls: coal's own boxes, nearly parallel, came out too shallow now and then."""
    import coal
    from scipy.spatial import ConvexHull as QuickHull

    if isinstance(shape, Sphere):
        return coal.Sphere(shape.radius)
    if isinstance(shape, Capsule):
        return coal.Capsule(shape.radius, shape.length)
    if isinstance(shape, Ellipsoid):
        return coal.Ellipsoid(*shape.radii)
    corners = CORNERS * np.array(shape.size) if isinstance(shape, Box) else shape.vertices
    assert isinstance(shape, Box | ConvexHull)
    hull = QuickHull(corners)
    number = np.zeros(len(corners), dtype=np.int64)
    number[hull.vertices] = np.arange(len(hull.vertices))
    points, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for corner in corners[hull.vertices]:
        points.append(corner)
    for corners_of, equation in zip(hull.simplices, hull.equations, strict=True):
        a, b, c = corners[corners_of]
        outward = float(np.cross(b - a, c - a) @ equation[:3]) > 0.0
        faces.append(coal.Triangle(*number[corners_of if outward else corners_of[::-1]].tolist()))
    return coal.Convex(points, faces)
