"""A small picture of a scene at one instant: its convex pieces in orthographic projection, shaded, as an SVG of a few kilobytes.

Colours are classes of the page's style sheet, so that one picture serves light and dark pages.
"""

import math
from html import escape

import numpy as np

from reports.drawing.convex_picture import Piece, flat_hull, order, placed
from reports.drawing.mesh import Array
from reports.reading.kept import Drawn, Shown

WIDTH, HEIGHT = 320, 200
"""Units of the picture, two per pixel of a card: whole numbers of them are as fine as a screen shows."""
MARGIN = 1.16
"""Width of the picture over that of the moving bodies: less cuts outlines off, more makes a hand a dot."""
ELEVATION = 0.4
"""Angle [rad] from which the eye looks down, as the replay does when it opens."""
LEAST_OFFSET = 0.01
"""Distance [m] from which the place of a tracked link is drawn as a ghost: nearer ones cannot be told from what is shown."""
MOST_FIXED = 60
"""Fixed pieces drawn at most, the largest in the picture: a room of two hundred plates is no clearer for all of them."""
MOST_FACES = 12
"""Polyhedra with more faces are drawn as one outline: their faces are too small to be told apart in a picture of 150 px."""
LIGHT = np.array([0.35, 0.5, 0.79]) / math.sqrt(0.35**2 + 0.5**2 + 0.79**2)
"""Direction to the light in the picture's own axes: right, towards the eye, up."""
SHADES = (0.75, 0.35)
"""Cosines to the light from which a face is light, and from which it is half light; below it is dark."""

View = tuple[Array, float]
"""Lower left corner [m] of a picture, and units of the picture per metre."""
Parts = list[tuple[Piece, str]]
"""Pieces, and the roles of their bodies."""


def thumbnail(scene: Drawn, main: Shown, state: int, turn: float, label: str, view: View | None = None) -> str:
    """Return the picture of what ``main`` shows in a state, "" where nothing moving can be drawn.

    Args:
        scene: of the picture.
        main: recording.
        state: number of the state.
        turn: azimuth [rad] of the eye.
        label: description of the picture.
        view: of another picture, to show the same part.
    """
    axes, towards = _eye(turn)
    parts, ghosts = _parts(scene, main, state)
    view = view or framed(scene, main, state, turn)
    if view is None or not ghosts and all(role == "fixed" for _, role in parts):
        return ""
    parts = _largest(parts, axes, view)
    pieces, outlines = [piece for piece, _ in parts], [piece.outline(axes) for piece, _ in parts]
    marks, moving = list[str](), list[Array]()
    for k in order(pieces, outlines, towards, HEIGHT / view[1]):
        role = parts[k][1]
        if role != "fixed":
            moving.append(outlines[k])
        elif any(_meet(one, outlines[k]) for one in moving):
            # before something that moves it is a veil
            role = "veil"
        marks += _marks(pieces[k], outlines[k], role[0], axes, towards, view)
    marks += [_path("g", ghost.outline(axes), view) for ghost in ghosts]
    head = f'<svg class="still" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(label, quote=True)}">'
    return f"{head}{''.join(marks)}</svg>"


def framed(scene: Drawn, main: Shown, state: int, turn: float) -> View | None:
    """Return the view that holds what moves in a state in its middle; None where nothing can be drawn."""
    parts, ghosts = _parts(scene, main, state)
    seen = [piece.outline(_eye(turn)[0]) for piece in [*(piece for piece, role in parts if role != "fixed"), *ghosts]]
    if not seen:
        return None
    points = np.concatenate(seen)
    low, high = points.min(axis=0), points.max(axis=0)
    scale = float((np.array([WIDTH, HEIGHT]) / np.maximum((high - low) * MARGIN, 1e-6)).min())
    return 0.5 * (low + high) - 0.5 * np.array([WIDTH, HEIGHT]) / scale, scale


def _meet(one: Array, other: Array) -> bool:
    """Return whether the boxes round two outlines share an area."""
    return bool((one.min(axis=0) < other.max(axis=0)).all() and (other.min(axis=0) < one.max(axis=0)).all())


def _parts(scene: Drawn, main: Shown, state: int) -> tuple[Parts, list[Piece]]:
    """Return the pieces of all bodies with a pose, and those of links that the tracker has elsewhere."""
    parts, ghosts = Parts(), list[Piece]()
    first_link = len(scene.bodies) - main.raw_positions.shape[1]
    for k, body in enumerate(scene.bodies):
        position, turn = main.positions[state, k], main.orientations[state, k]
        if np.isfinite(position).all() and np.isfinite(turn).all():
            parts += [(placed(piece, position, turn), str(body["role"])) for piece in body["pieces"]]
        if k >= first_link:
            target, turn = main.raw_positions[state, k - first_link], main.raw_orientations[state, k - first_link]
            if LEAST_OFFSET < np.linalg.norm(target - position) < math.inf and np.isfinite(turn).all():
                ghosts += [placed(piece, target, turn) for piece in body["pieces"]]
    return parts, ghosts


def _eye(turn: float) -> tuple[Array, Array]:
    """Return the axes (2, 3) of the picture, right and up, and the direction (3,) to the eye."""
    flat, high = math.cos(ELEVATION), math.sin(ELEVATION)
    towards = np.array([math.cos(turn) * flat, math.sin(turn) * flat, high])
    right = np.array([-math.sin(turn), math.cos(turn), 0.0])
    return np.stack([right, np.cross(towards, right)]), towards


def _largest(parts: Parts, axes: Array, view: View) -> Parts:
    """Return all parts that move, and the largest of the fixed ones in the picture before them."""
    areas = []
    for part in parts:
        spots = (part[0].outline(axes) - view[0]) * view[1]
        span = np.minimum(spots.max(axis=0), (WIDTH, HEIGHT)) - np.maximum(spots.min(axis=0), 0.0)
        if part[1] == "fixed" and (span > 0.0).all():
            areas.append((float(span.prod()), part))
    areas.sort(key=lambda one: one[0], reverse=True)
    return [part for _, part in areas[:MOST_FIXED]] + [part for part in parts if part[1] != "fixed"]


def _marks(piece: Piece, outline: Array, letter: str, axes: Array, towards: Array, view: View) -> list[str]:
    """Return the paths of one piece: the faces that look towards the eye, or its outline where it is round or has many."""
    if not 0 < len(piece.faces) <= MOST_FACES:
        return [_path(f"{letter}2", outline, view)]
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
    kept = [spot for k, spot in enumerate(whole) if spot != whole[k - 1]]
    text = "".join(f"{'L' if k else 'M'}{x},{y}" for k, (x, y) in enumerate(kept))
    return f'<path class="{style}" d="{text}Z"/>' if len(kept) > 1 else ""


def _cut(polygon: Array) -> Array:
    """Return a convex polygon (k, 2) cut at a border a little outside of the picture (Sutherland and Hodgman 1974): a floor of a
    kilometre has corners that no renderer draws exactly."""
    for axis, limit, sign in ((0, -8.0, 1.0), (0, WIDTH + 8.0, -1.0), (1, -8.0, 1.0), (1, HEIGHT + 8.0, -1.0)):
        inside, kept = sign * (polygon[:, axis] - limit), list[Array]()
        for k in range(len(polygon)):
            last = inside[k - 1]
            if (last < 0.0) != (inside[k] < 0.0):
                kept.append(polygon[k - 1] + (polygon[k] - polygon[k - 1]) * (last / (last - inside[k])))
            if inside[k] >= 0.0:
                kept.append(polygon[k])
        polygon = np.array(kept).reshape(-1, 2)
    return polygon
