"""A small picture of a scene at one instant: its convex pieces in orthographic projection, shaded, as an SVG of a few kilobytes.

Colours are classes of the page's style sheet, so that one picture serves light and dark pages.
"""

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from reports.drawing.convex_picture import MOST_FACES, Array, Piece, order, placed
from reports.reading.kept import Drawn, Shown

WIDTH, HEIGHT = 320, 200
"""Units of the picture, two per pixel of a card: whole numbers of them are as fine as a screen shows."""
MARGIN = 1.16
"""How much wider than what moves the picture is: less cuts outlines off, more makes a hand a dot."""
ELEVATION = 0.4
"""Angle [rad] from which the eye looks down, as the replay does when it opens."""
LEAST_OFFSET = 0.01
"""Distance [m] from which the place of a tracked link is drawn as a ghost: nearer ones cannot be told from what is shown."""
MOST_FIXED = 60
"""Fixed pieces drawn at most, the largest in the picture: a room of two hundred plates is no clearer for all of them."""
LIGHT = np.array([0.35, -0.5, 0.79])
"""Direction of the light in the picture's own axes: right, towards the eye, up."""
SHADES = (0.75, 0.35)
"""Cosines to the light from which a face is light, and from which it is half light; below it is dark."""


def thumbnail(scene: Drawn, main: Shown, state: int, turn: float, label: str, view: tuple[Array, float] | None = None) -> str:
    """Return the picture of what `main` shows in a state, seen from the azimuth `turn` [rad] and described by `label`; "" where
    nothing of it can be drawn. `view`: corner and scale of another picture, to show the same part."""
    moving = [k for k, body in enumerate(scene.bodies) if body["role"] != "fixed"]
    bodies = _placed(scene, main, state)
    ghosts = _ghosts(scene, main, state)
    seen = [piece for k in moving for piece in bodies[k]] + ghosts
    if not seen:
        return ""
    axes, towards = _eye(turn)
    low, scale = view or _frame([piece.outline(axes) for piece in seen])
    pieces, roles = _in_picture(scene, bodies, axes, low, scale)
    outlines = [piece.outline(axes) for piece in pieces]
    marks = []
    drawn = list[int]()
    for k in order(pieces, outlines, towards, HEIGHT / scale):
        # what is fixed and stands before what moves is drawn as a veil
        veils = roles[k] == "fixed" and any(roles[j] != "fixed" and _meet(outlines[j], outlines[k]) for j in drawn)
        marks += _marks(pieces[k], outlines[k], "veil" if veils else roles[k], axes, towards, low, scale)
        drawn.append(k)
    marks += [_path("g", piece.outline(axes), low, scale) for piece in ghosts]
    return (
        f'<svg class="still" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(label, quote=True)}">'
        + "".join(marks)
        + "</svg>"
    )


def framed(scene: Drawn, main: Shown, state: int, turn: float) -> tuple[Array, float] | None:
    """Return corner and scale of the picture of what `main` shows in a state; None where nothing of it can be drawn."""
    moving = [k for k, body in enumerate(scene.bodies) if body["role"] != "fixed"]
    bodies = _placed(scene, main, state)
    seen = [piece for k in moving for piece in bodies[k]] + _ghosts(scene, main, state)
    return _frame([piece.outline(_eye(turn)[0]) for piece in seen]) if seen else None


def _meet(one: Array, other: Array) -> bool:
    """Whether the boxes round two outlines share an area."""
    return bool((one.min(axis=0) < other.max(axis=0)).all() and (other.min(axis=0) < one.max(axis=0)).all())


def _placed(scene: Drawn, main: Shown, state: int) -> list[list[Piece]]:
    """The pieces of each body in the world; none of a body whose pose is no number."""
    found = []
    for k, body in enumerate(scene.bodies):
        position, turn = main.positions[state, k], main.orientations[state, k]
        sound = bool(np.isfinite(position).all() and np.isfinite(turn).all())
        found.append([placed(piece, position, turn) for piece in body["pieces"]] if sound else [])
    return found


def _ghosts(scene: Drawn, main: Shown, state: int) -> list[Piece]:
    """The pieces of the links where the raw tracker has them, of those that are shown elsewhere."""
    links = main.raw_positions.shape[1]
    found: list[Piece] = []
    for slot, k in enumerate(range(len(scene.bodies) - links, len(scene.bodies))):
        position, turn = main.raw_positions[state, slot], main.raw_orientations[state, slot]
        apart = float(np.linalg.norm(position - main.positions[state, k]))
        if LEAST_OFFSET < apart < math.inf and np.isfinite(turn).all():
            found += [placed(piece, position, turn) for piece in scene.bodies[k]["pieces"]]
    return found


def _eye(turn: float) -> tuple[Array, Array]:
    """(axes (2, 3) of the picture: right and up; direction towards the eye)."""
    flat, high = math.cos(ELEVATION), math.sin(ELEVATION)
    towards = np.array([math.cos(turn) * flat, math.sin(turn) * flat, high])
    right = np.array([-math.sin(turn), math.cos(turn), 0.0])
    return np.stack([right, np.cross(towards, right)]), towards


def _frame(outlines: Sequence[Array]) -> tuple[Array, float]:
    """(lower left corner of the picture [m], units of the picture per metre) that hold all outlines, in their middle."""
    points = np.concatenate(outlines)
    low, high = points.min(axis=0), points.max(axis=0)
    span = np.maximum((high - low) * MARGIN, 1e-6)
    scale = float(min(WIDTH / span[0], HEIGHT / span[1]))
    return 0.5 * (low + high) - 0.5 * np.array([WIDTH, HEIGHT]) / scale, scale


def _in_picture(
    scene: Drawn, bodies: Sequence[Sequence[Piece]], axes: Array, low: Array, scale: float
) -> tuple[list[Piece], list[str]]:
    """(pieces, role of each) that the picture shows: all that move, and the largest of the fixed ones."""
    moving: list[tuple[Piece, str]] = []
    fixed: list[tuple[float, int, Piece]] = []
    for k, body in enumerate(scene.bodies):
        for piece in bodies[k]:
            if body["role"] != "fixed":
                moving.append((piece, str(body["role"])))
                continue
            spots = (piece.outline(axes) - low) * scale
            span = np.minimum(spots.max(axis=0), (WIDTH, HEIGHT)) - np.maximum(spots.min(axis=0), 0.0)
            if (span > 0.0).all():
                fixed.append((float(span.prod()), len(fixed), piece))
    fixed.sort(key=lambda one: one[:2], reverse=True)
    kept = [(piece, "fixed") for _, _, piece in fixed[:MOST_FIXED]] + moving
    return [piece for piece, _ in kept], [role for _, role in kept]


def _marks(piece: Piece, outline: Array, role: str, axes: Array, towards: Array, low: Array, scale: float) -> list[str]:
    """The paths of one piece: the faces that look towards the eye, or its outline where it is round or has many."""
    letter = role[0]
    if piece.radius():
        x, y = np.rint((axes @ piece.centre - low) * scale).astype(int)
        return [f'<circle class="{letter}2" cx="{x}" cy="{HEIGHT - y}" r="{max(1, round(piece.radius() * scale))}"/>']
    faces = [(corners, normal) for corners, normal in piece.faces() if normal @ towards > 1e-9]
    if not faces or len(piece.faces()) > MOST_FACES:
        return [_path(f"{letter}2", outline, low, scale)]
    own = np.stack([axes[0], towards, axes[1]])
    marks = []
    for corners, normal in faces:
        lit = float(own @ normal @ (LIGHT * (1.0, -1.0, 1.0)) / np.linalg.norm(LIGHT))
        shade = 1 if lit > SHADES[0] else 2 if lit > SHADES[1] else 3
        marks.append(_path(f"{letter}{shade}", corners @ axes.T, low, scale))
    return marks


def _path(style: str, points: Array, low: Array, scale: float) -> str:
    """A closed polygon, cut at the edges of the picture, in whole units; "" where nothing of it is inside."""
    spots = (points - low) * scale
    spots[:, 1] = HEIGHT - spots[:, 1]
    spots = np.rint(_cut(spots)).astype(int)
    kept = [spot for k, spot in enumerate(spots.tolist()) if spot != spots[k - 1].tolist()]
    if len(kept) < 2:
        return ""
    text = "".join(f"{'M' if k == 0 else 'L'}{x},{y}" for k, (x, y) in enumerate(kept))
    return f'<path class="{style}" d="{text}Z"/>'


def _cut(polygon: Array) -> Array:
    """A convex polygon (k, 2), cut at a border a little outside of the picture (Sutherland and Hodgman): a floor of a kilometre
    has corners that no renderer draws exactly."""
    for axis, limit, sign in ((0, -8.0, 1.0), (0, WIDTH + 8.0, -1.0), (1, -8.0, 1.0), (1, HEIGHT + 8.0, -1.0)):
        inside = sign * (polygon[:, axis] - limit)
        kept: list[Array] = []
        for k in range(len(polygon)):
            last = inside[k - 1]
            if (last < 0.0) != (inside[k] < 0.0):
                kept.append(polygon[k - 1] + (polygon[k] - polygon[k - 1]) * (last / (last - inside[k])))
            if inside[k] >= 0.0:
                kept.append(polygon[k])
        polygon = np.array(kept).reshape(-1, 2)
        if not len(polygon):
            break
    return polygon
