"""Data of the player: meshes once, the poses of moving bodies in whole numbers of 16 bits, captions, moments, the camera."""

import base64
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.player.surfaces import Surface

Array = NDArray[np.float64]

OVERLAP, GHOST, MOVES = "overlap", "ghost", "moves"
"""Kinds of captions: the view overlaps, only its ghost overlaps, it moves in a remarkable way."""
MISSING, LEAST, MOST = 0, 1, 65535
"""The code of a number that is not finite, and the codes of the least and the greatest value."""
AIR = 0.25
"""Share by which the box of all bodies is wider than the leading view and the ghost; bodies beyond it are drawn at its edge."""
CLOSEST = 1.0 / 3.0
"""Least share of the extent of the whole motion that a following view shows: a fist alone shows none of its surroundings."""
FOLLOWS = 0.85
"""Share of the extent of the whole motion below which the views follow at first."""


@dataclass(frozen=True, eq=False)
class BodyMesh:
    """A body: its role ("fixed", "furniture", "simulated" or "driven"), its surface, and that of the shapes tested for overlap
    where it differs. Equal surfaces are stored once."""

    role: str
    surface: Surface
    tested: Surface | None = None


@dataclass(frozen=True, eq=False)
class Poses:
    """Positions (F, m, 3) [m] and orientations (F, m, 4) of m bodies in F states."""

    positions: Array
    orientations: Array


@dataclass(frozen=True)
class Moment:
    """A state with a button, the button's text, and whether it is one of the worst."""

    state: int
    said: str
    is_worst: bool = False


@dataclass(frozen=True, eq=False)
class View:
    """One of the pictures shown side by side.

    label    its name
    colour   of its dot, in CSS
    poses    of the moving bodies; it may end before the other views
    captions (kind, text) by state, where they are not those of a calm state
    pairs    overlapping bodies by state, the deepest first
    moments  states with a button
    """

    label: str
    colour: str
    poses: Poses
    captions: Mapping[int, tuple[str, str]] = field(default_factory=dict)
    pairs: Mapping[int, Sequence[tuple[int, int]]] = field(default_factory=dict)
    moments: Sequence[Moment] = ()


def payload(
    bodies: Sequence[BodyMesh], still: Mapping[int, tuple[Array, Array]], times: Array, views: Sequence[View], leader: int,
    ghost: tuple[str, Sequence[int], Poses] | None, azimuth: Callable[[Array, float], float], **more: object,
) -> dict[str, Any]:
    """Return the data of the player, ready for JSON.

    Args:
        bodies: all bodies.
        still: position and orientation of those that do not move; the others move.
        times: (F,) [s] of the states, from 0 on.
        views: side by side.
        leader: number of the view whose bodies all views follow.
        ghost: its name, its bodies and their poses, drawn as a veil in each view; views follow these bodies, else all that move.
        azimuth: of the camera at first [rad], for the middle (3,) [m] and the radius [m] of the whole motion.
        more: `name`, `ghost_overlaps` (pairs of bodies by state), `calm` (caption of other states), `opens` (state), `frames`
            (numbers of the states), `ground` (flag: lines at z = 0).
    """
    shapes = dict[tuple[bytes, bytes], tuple[int, Surface]]()

    def mesh(of: Surface) -> int:
        return shapes.setdefault((of[0].tobytes(), of[1].tobytes()), (len(shapes), of))[0]

    body_entries = [
        {"role": body.role, "mesh": mesh(body.surface), **({} if body.tested is None else {"tested": mesh(body.tested)})}
        for body in bodies
    ]
    moving, main = [k for k in range(len(bodies)) if k not in still], views[leader].poses.positions
    followed, target = (moving, main[:, :0]) if ghost is None else (list(ghost[1]), ghost[2].positions)
    reach = [float(np.linalg.norm(body.surface[0], axis=1).max(initial=0.0)) for body in bodies]
    low, high = _span(np.concatenate([main.reshape(-1, 3), target.reshape(-1, 3)]), max((reach[k] for k in moving), default=0.1))
    margin, focus, radius = AIR * (high - low) + 0.5, 0.5 * (low + high), float(0.5 * np.linalg.norm(high - low))
    box = low - margin, high + margin
    # the ghost must be visible too, and may be far from the leading view
    seen = np.concatenate([main[:, [moving.index(k) for k in followed]], target[: len(main)]], axis=1)
    near = max(_near(seen, [reach[k] for k in followed] * (1 if ghost is None else 2)), CLOSEST * radius)
    return {
        "times": [float(f"{time:.7g}") for time in times], "low": box[0].tolist(), "high": box[1].tolist(),
        "meshes": [_mesh(*of) for _, of in shapes.values()],
        "bodies": body_entries,
        "still": [{"body": k, "place": place.tolist(), "turn": turn.tolist()} for k, (place, turn) in still.items()],
        "moving": moving,
        "ghost": None if ghost is None else {"name": ghost[0], "bodies": list(ghost[1]), **_encoded(ghost[2], box)},
        "views": [
            {
                "label": view.label, "colour": view.colour, **_encoded(view.poses, box),
                "captions": view.captions, "pairs": view.pairs, "moments": [vars(moment) for moment in view.moments],
            }
            for view in views
        ],
        "eye": {
            "focus": focus.tolist(), "radius": radius, "near": near, "least": CLOSEST * radius,
            "follows": near < FOLLOWS * radius, "followed": followed, "leader": leader,
            "reach": max((reach[k] for k in followed), default=0.0), "azimuth": azimuth(focus, radius),
        },
        **more,
    }


def _mesh(points: Array, faces: NDArray[np.int64]) -> dict[str, object]:
    """Return a mesh as text, its corners to 1e-5 of its size."""
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    index = np.uint16 if len(points) <= 1 << 16 else np.uint32
    return {
        "low": low.tolist(), "high": high.tolist(), "corners": text(codes(points, low, high)), "faces": text(faces.astype(index)),
    }


def _span(places: Array, reach: float) -> tuple[Array, Array]:
    """Return the box round all places but outliers of a percent, wider by the ``reach`` of a body."""
    sound = places[np.isfinite(places).all(axis=1)]
    if not len(sound):
        return np.full(3, -1.0), np.full(3, 1.0)
    return np.percentile(sound, 1.0, axis=0) - reach, np.percentile(sound, 99.0, axis=0) + reach


def _near(positions: Array, reach: Sequence[float]) -> float:
    """Return the radius [m] of a ball round the middle of bodies (F, m, 3) that contains nearly all of them nearly always."""
    sound = positions[np.isfinite(positions).all(axis=(1, 2))]
    if not sound.size:
        return 1.0
    apart = np.linalg.norm(sound - sound.mean(axis=1, keepdims=True), axis=2) + np.array(reach)
    return float(np.percentile(apart.max(axis=1), 95.0))


def _encoded(poses: Poses, box: tuple[Array, Array]) -> dict[str, object]:
    """Return poses as text, each part of a quaternion to 3e-5; a body without an orientation has no place either."""
    is_finite = np.isfinite(poses.orientations).all(axis=-1, keepdims=True)
    places = codes(np.where(is_finite, poses.positions, np.nan), *box)
    turns = np.rint(np.clip(np.nan_to_num(poses.orientations), -1.0, 1.0) * 32767.0).astype(np.int16)
    return {"states": len(poses.positions), "places": text(places), "turns": text(turns)}


def codes(values: Array, low: Array | float, high: Array | float) -> NDArray[np.uint16]:
    """Spread values evenly from LEAST at ``low`` to MOST at ``high``; MISSING for values that are not finite."""
    share = (np.clip(np.where(np.isfinite(values), values, low), low, high) - low) / np.maximum(np.subtract(high, low), 1e-300)
    return np.asarray(np.where(np.isfinite(values), LEAST + np.rint(share * (MOST - LEAST)), MISSING), dtype=np.uint16)


def text(values: NDArray[Any]) -> str:
    """Return the bytes of ``values``, little end first, as base64."""
    return base64.b64encode(np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes()).decode("ascii")
