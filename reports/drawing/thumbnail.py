"""A small picture of a scene at one instant: its convex pieces in orthographic projection, shaded, as an SVG of a few kilobytes.

Fixed pieces are drawn first, the largest before all, and then moving ones from far to near, so that nothing hides what moves.
Colours are classes of the page's style sheet, so that one picture serves light and dark pages.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from html import escape

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from avatarsim.player import surfaces
from avatarsim.player.surfaces import Indices
from avatarsim.scene.shape import Piece as Shape
from avatarsim.spatial import rotation
from reports.reading.kept import Array, Drawn, Shown

WIDTH, HEIGHT = 320, 200
"""Units of the picture, two per pixel of a card: whole numbers of them are as fine as a screen shows."""
MARGIN = 1.16
"""Width of the picture over that of the moving bodies: less cuts outlines off, more makes a hand a dot."""
ELEVATION = 0.4
"""Angle [rad] from which the eye looks down, as the replay does when it opens."""
LEAST_OFFSET = 0.01
"""Distance [m] from which the place of a tracked link is drawn as a ghost: nearer ones cannot be told from what is shown."""
MAX_FIXED = 60
"""Fixed pieces drawn at most, the largest in the picture: a room of two hundred plates is no clearer for all of them."""
MAX_FACES = 12
"""Polyhedra with more faces are drawn as one outline: their faces are too small to be told apart in a picture of 150 px."""
LIGHT = np.array([0.35, 0.5, 0.79]) / math.sqrt(0.35**2 + 0.5**2 + 0.79**2)
"""Direction to the light in the picture's own axes: right, towards the eye, up."""
SHADES = (0.75, 0.35)
"""Cosines to the light from which a face is light, and from which it is half light; below it is dark."""

View = tuple[Array, float]
"""Lower left corner [m] of a picture, and units of the picture per metre."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A convex piece of a body in the world.

    role     of its body, "ghost" where the tracker has a link elsewhere
    corners  (v, 3) [m]
    faces    corners of each flat face, none of a round piece
    normals  of the faces (f, 3), outward
    """

    role: str
    corners: Array
    faces: list[Indices]
    normals: Array

    def outline(self, axes: Array) -> Array:
        """Return the corners (k, 2) of its outline along ``axes`` (2, 3), in order."""
        return flat_hull(self.corners @ axes.T)


def placed(role: str, piece: Shape, position: Array, orientation: Array) -> Piece:
    """Return a piece on a body at ``position`` (3,) with ``orientation`` (4,)."""
    own, faces, normals = _faces(piece)
    return Piece(role, position + rotation.rotate(orientation, own), faces, rotation.rotate(orientation, normals))


@lru_cache(maxsize=512)
def _faces(piece: Shape) -> tuple[Array, list[Indices], Array]:
    """Return corners of a piece in the frame of its body, and flat faces with their normals, none of a round piece."""
    own = surfaces.corners(piece)
    if surfaces.is_round(piece.shape):
        return own, [], np.zeros((0, 3))
    triangles, equations = surfaces.hull(own)
    # triangles of one plane are one face
    planes, which = np.unique(np.round(equations, 5) + 0.0, axis=0, return_inverse=True)
    return own, [np.unique(triangles[which == k]) for k in range(len(planes))], planes[:, :3]


def flat_hull(points: Array) -> Array:
    """Return the corners (k, 2) of the hull of points (n, 2), counter-clockwise; the points where they span no area."""
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:
        return points


def thumbnail(scene: Drawn, main: Shown, state: int, turn: float, label: str, view: View | None = None) -> str:
    """Return the picture of what ``main`` shows in a state, "" where nothing moving can be drawn.

    ``turn`` is the azimuth [rad] of the eye, ``label`` describes the picture, ``view`` is that of a picture of the same part.
    """
    axes, towards = _eye(turn)
    pieces, view = _pieces(scene, main, state), view or framed(scene, main, state, turn)
    if view is None or all(piece.role == "fixed" for piece in pieces):
        return ""
    head = f'<svg class="still" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(label, quote=True)}">'
    marks = [mark for piece in _order(pieces, axes, towards, view) for mark in _marks(piece, axes, towards, view)]
    return f"{head}{''.join(marks)}</svg>"


def framed(scene: Drawn, main: Shown, state: int, turn: float) -> View | None:
    """Return the view that holds what moves in a state in its middle; None where nothing can be drawn."""
    seen = [piece.outline(_eye(turn)[0]) for piece in _pieces(scene, main, state) if piece.role != "fixed"]
    if not seen:
        return None
    points = np.concatenate(seen)
    low, high = points.min(axis=0), points.max(axis=0)
    scale = float((np.array([WIDTH, HEIGHT]) / np.maximum((high - low) * MARGIN, 1e-6)).min())
    return 0.5 * (low + high) - 0.5 * np.array([WIDTH, HEIGHT]) / scale, scale


def _pieces(scene: Drawn, main: Shown, state: int) -> list[Piece]:
    """Return the pieces of all bodies with a pose, and then those of links that the tracker has elsewhere."""
    pieces, ghosts = list[Piece](), list[Piece]()
    first_link = len(scene.bodies) - main.raw_positions.shape[1]
    for k, body in enumerate(scene.bodies):
        position, turn = main.positions[state, k], main.orientations[state, k]
        if np.isfinite(position).all() and np.isfinite(turn).all():
            pieces += [placed(str(body["role"]), piece, position, turn) for piece in body["pieces"]]
        if k >= first_link:
            target, turn = main.raw_positions[state, k - first_link], main.raw_orientations[state, k - first_link]
            if LEAST_OFFSET < np.linalg.norm(target - position) < math.inf and np.isfinite(turn).all():
                ghosts += [placed("ghost", piece, target, turn) for piece in body["pieces"]]
    return pieces + ghosts


def _eye(turn: float) -> tuple[Array, Array]:
    """Return the axes (2, 3) of the picture, right and up, and the direction (3,) to the eye."""
    flat, high = math.cos(ELEVATION), math.sin(ELEVATION)
    towards = np.array([math.cos(turn) * flat, math.sin(turn) * flat, high])
    right = np.array([-math.sin(turn), math.cos(turn), 0.0])
    return np.stack([right, np.cross(towards, right)]), towards


def _order(pieces: list[Piece], axes: Array, towards: Array, view: View) -> list[Piece]:
    """Return the pieces to draw, one after the other: the largest fixed ones in the picture, moving ones, ghosts."""

    def area(piece: Piece) -> float:
        spots = (piece.outline(axes) - view[0]) * view[1]
        span = np.minimum(spots.max(axis=0), (WIDTH, HEIGHT)) - np.maximum(spots.min(axis=0), 0.0)
        return float(np.maximum(span, 0.0).prod())

    areas = [(area(piece), piece) for piece in pieces if piece.role == "fixed"]
    fixed = sorted((one for one in areas if one[0] > 0.0), key=lambda one: -one[0])[:MAX_FIXED]
    moving = [piece for piece in pieces if piece.role not in ("fixed", "ghost")]
    moving.sort(key=lambda piece: float(piece.corners.mean(axis=0) @ towards))
    return [piece for _, piece in fixed] + moving + [piece for piece in pieces if piece.role == "ghost"]


def _marks(piece: Piece, axes: Array, towards: Array, view: View) -> list[str]:
    """Return the paths of one piece: the faces that look towards the eye, or its outline where it is round or has many."""
    letter = piece.role[0]
    if letter == "g" or not 0 < len(piece.faces) <= MAX_FACES:
        return [_path("g" if letter == "g" else f"{letter}2", piece.outline(axes), view)]
    marks = []
    for face, normal in zip(piece.faces, piece.normals, strict=True):
        if normal @ towards > 1e-9:
            lit = float(np.stack([axes[0], towards, axes[1]]) @ normal @ LIGHT)
            shade = 1 if lit > SHADES[0] else 2 if lit > SHADES[1] else 3
            marks.append(_path(f"{letter}{shade}", flat_hull(piece.corners[face] @ axes.T), view))
    return marks


def _path(style: str, points: Array, view: View) -> str:
    """Return a closed polygon, cut at the edges of the picture, in whole units; "" where nothing of it is inside."""
    spots = (points - view[0]) * view[1]
    spots[:, 1] = HEIGHT - spots[:, 1]
    whole = np.rint(_cut(spots)).astype(int).tolist()
    distinct = [spot for k, spot in enumerate(whole) if spot != whole[k - 1]]
    text = "".join(f"{'L' if k else 'M'}{x},{y}" for k, (x, y) in enumerate(distinct))
    return f'<path class="{style}" d="{text}Z"/>' if len(distinct) > 1 else ""


def _cut(polygon: Array) -> Array:
    """Return a convex polygon (k, 2) cut a little outside of the picture (Sutherland and Hodgman 1974): no renderer draws
    the corners of a floor of a kilometre exactly."""
    for axis, limit, sign in ((0, -8.0, 1.0), (0, WIDTH + 8.0, -1.0), (1, -8.0, 1.0), (1, HEIGHT + 8.0, -1.0)):
        inside, clipped = sign * (polygon[:, axis] - limit), list[Array]()
        for k in range(len(polygon)):
            last = inside[k - 1]
            if (last < 0.0) != (inside[k] < 0.0):
                clipped.append(polygon[k - 1] + (polygon[k] - polygon[k - 1]) * (last / (last - inside[k])))
            if inside[k] >= 0.0:
                clipped.append(polygon[k])
        polygon = np.array(clipped).reshape(-1, 2)
    return polygon
