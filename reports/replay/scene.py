"""Data for a page that plays a scene again: meshes once, and per engine the poses of moving bodies, packed small."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from avatarsim.spatial import rotation
from reports.drawing import mesh
from reports.drawing.stills import sides
from reports.reading.kept import Array, Drawn, Shown
from reports.replay import packed
from reports.replay.moments import Kind, Moment, moments, remarks
from reports.tables.figures import quantity

SEEN = 1e-6
"""Depth [m] from which a pair is marked, the bound on what may be shown."""
MOST_FRAMES = 600
"""States drawn per engine at most: ten seconds; longer scenes leave out states evenly."""
MOST_BYTES = 1_600_000
"""Bytes of all poses of a page before they become text (a third more): with three.js a page stays below 3 MB."""
BYTES_PER_POSE = 14
"""Three places and four parts of a quaternion, 16 bits each."""
AIR = 0.25
"""Share by which the box of all drawn bodies is wider than what the gated engine and the tracker do; bodies beyond it are drawn
at its edge."""
LEAST = 1.0 / 3.0
"""Least share of the room of the whole motion that a view which follows shows: a fist alone says nothing of what it meets."""
FAR = 0.85
"""The view follows driven bodies where that needs less than this share of the room that the whole motion needs."""
FIRST = (Kind.NO_NUMBER, Kind.OVERLAP, Kind.JUMP, Kind.ORIENTATION, Kind.BACK)
"""Kinds of moments on which a page opens, those first that come first; then any other."""
AZIMUTHS = (-60.0, -30.0, -120.0, -90.0, 60.0, 120.0, 0.0, 180.0, 30.0, 150.0)
"""Directions [deg] of the eye, the preferred one first."""


def stride(frames: Sequence[int], moving: int) -> int:
    """Return every how many-th state is drawn, for engines with so many ``frames`` and ``moving`` bodies each."""
    bytes_all = sum(frames) * moving * BYTES_PER_POSE
    return max(1, math.ceil(bytes_all / MOST_BYTES), math.ceil(max(frames, default=1) / MOST_FRAMES))


def replay(
    scene: Drawn, shown: Sequence[Shown], ours: str, depths: Mapping[str, Array] | None = None
) -> dict[str, object] | None:
    """Return the data of a replay, ready for JSON; None when nothing was recorded.

    Args:
        scene: of the replay.
        shown: recordings.
        ours: run that the view fits.
        depths: overlaps [m] of the judge by run, not a number where it found no pose to judge.
    """
    engines, judged = [one for one in shown if not one.run.startswith("tracker/")], depths or {}
    if not engines:
        return None
    moving = [k for k, body in enumerate(scene.bodies) if body["role"] != "fixed"]
    main = next((one for one in engines if one.run == ours), engines[0])
    count = main.raw_positions.shape[1]
    links = list(range(len(scene.bodies) - count, len(scene.bodies)))
    step = stride([len(one.times) for one in engines] + [len(main.times)] * bool(count), max(1, len(moving)))
    shapes, which = _meshes(scene)
    reach = [float(np.linalg.norm(shapes[k][0], axis=1).max(initial=0.0)) for k in which]
    places = np.concatenate([main.positions[:, moving].reshape(-1, 3), main.raw_positions.reshape(-1, 3)])
    low, high = _span(places, max((reach[k] for k in moving), default=0.1))
    margin = AIR * (high - low) + 0.5
    box, radius, followed = (low - margin, high + margin), float(0.5 * np.linalg.norm(high - low)), links or moving
    names, worst = scene.names_of_links(count), dict[str, tuple[Moment, ...]]()
    for one in engines:
        worst[one.run] = moments(one, judged.get(one.run), names)
    # the user too is to be seen, whose place may be far from what is shown
    seen = np.concatenate([main.positions[:, followed], main.raw_positions], axis=1)
    near = max(_near(seen, [reach[k] for k in followed] * (2 if count else 1)), LEAST * radius)
    return {
        "dt": float(main.times[1] - main.times[0]) * step if len(main.times) > 1 else 1.0 / 60.0,
        "low": box[0].tolist(), "high": box[1].tolist(), "focus": (0.5 * (low + high)).tolist(),
        "radius": radius, "followed": followed, "near": near, "least": LEAST * radius, "follow": near < FAR * radius,
        "leader": engines.index(main), "reach": [reach[k] for k in followed], "opens": opening(engines, worst, ours, step),
        "azimuth": azimuth(scene, [shapes[k][0] for k in which], main, 0.5 * (low + high), 2.0 * radius),
        "meshes": [
            {"corners": packed.text(points.astype(np.float32)), "faces": packed.text(faces.astype(np.uint32))}
            for points, faces in shapes
        ],
        "bodies": [{"name": body["name"], "role": body["role"], "mesh": which[k]} for k, body in enumerate(scene.bodies)],
        "still": [
            {"body": k, "place": main.positions[0, k].tolist(), "turn": main.orientations[0, k].tolist()}
            for k in range(len(scene.bodies))
            if k not in moving
        ],
        "moving": moving, "links": links,
        "ghost": _poses(main.raw_positions[::step], main.raw_orientations[::step], *box) if count else None,
        "runs": [
            {
                "run": one.run,
                **_poses(one.positions[::step][:, moving], one.orientations[::step][:, moving], *box),
                "pairs": _pairs(one, step),
                "worst": [{"state": found.state // step, "said": found.said} for found in worst[one.run]],
                "remarks": remarks(one, step),
                "broken": _broken(one, step, judged.get(one.run)),
            }
            for one in engines
        ],
    }


def _meshes(scene: Drawn) -> tuple[list[mesh.Mesh], list[int]]:
    """Return the different meshes, and the place of each body's: a heap of 216 equal balls is one mesh."""
    keys = [repr(body["pieces"]) for body in scene.bodies]
    known = {key: mesh.body(body["pieces"]) for key, body in dict(zip(keys, scene.bodies, strict=True)).items()}
    return list(known.values()), [list(known).index(key) for key in keys]


def _span(places: Array, reach: float) -> tuple[Array, Array]:
    """Return the box round all places but outliers of a percent, wider by the ``reach`` of a body."""
    sound = places[np.isfinite(places).all(axis=1)]
    if not len(sound):
        return np.full(3, -1.0), np.full(3, 1.0)
    return np.percentile(sound, 1.0, axis=0) - reach, np.percentile(sound, 99.0, axis=0) + reach


def _near(positions: Array, reach: Sequence[float]) -> float:
    """Return the radius [m] of a ball round the middle of bodies (F, m, 3) that holds nearly all of them nearly always."""
    sound = positions[np.isfinite(positions).all(axis=(1, 2))]
    if not sound.size:
        return 1.0
    apart = np.linalg.norm(sound - sound.mean(axis=1, keepdims=True), axis=2) + np.array(reach)
    return float(np.percentile(apart.max(axis=1), 95.0))


def _poses(positions: Array, orientations: Array, low: Array, high: Array) -> dict[str, object]:
    """Return positions (F, m, 3) and orientations (F, m, 4) as text; a body without an orientation is nowhere either."""
    positions = np.where(np.isfinite(orientations).all(axis=-1, keepdims=True), positions, np.nan)
    places = packed.text(packed.codes(positions, low, high))
    return {"frames": len(positions), "places": places, "turns": packed.quaternions(orientations)}


def _pairs(one: Shown, step: int) -> list[list[tuple[int, int, str]]]:
    """Return per drawn state the pairs (body, body, depth) of the state that overlaps most of those that it represents."""
    states = [list[tuple[int, int, float]]() for _ in one.times]
    for frame, first, second, depth in one.pairs:
        if depth > SEEN:
            states[frame].append((first, second, depth))
    groups = [states[k : k + step] for k in range(0, len(states), step)]
    worst = [max(group, key=lambda pairs: pairs[0][2] if pairs else 0.0) for group in groups]
    return [[(first, second, quantity(depth, "m")) for first, second, depth in pairs] for pairs in worst]


def opening(
    engines: Sequence[Shown], worst: Mapping[str, Sequence[Moment]], ours: str, step: int
) -> dict[str, dict[str, object]]:
    """Return the drawn states to open on, each with its run, where there is such a moment.

    "ours" is the worst moment of the gated engine, by the order of FIRST; "others" the deepest overlap of the others.
    """
    found: dict[str, dict[str, object]] = {}
    if own := worst.get(ours, ()):
        first = min(own, key=lambda one: FIRST.index(one.kind) if one.kind in FIRST else len(FIRST))
        found["ours"] = {"state": first.state // step, "run": ours}
    pairs = [(depth, -frame, one.run) for one in engines if one.run != ours for frame, _, _, depth in one.pairs]
    if pairs:
        _, frame, run = max(pairs)
        found["others"] = {"state": -frame // step, "run": run}
    return found


def _broken(one: Shown, step: int, depth: Array | None) -> list[int]:
    """Return the drawn states that represent one in which a pose is no number, or no pose."""
    wrong = ~(np.isfinite(one.positions).all(axis=(1, 2)) & np.isfinite(one.orientations).all(axis=(1, 2)))
    if depth is not None and depth.size == wrong.size:
        wrong |= ~np.isfinite(depth)
    return sorted({int(frame) // step for frame in np.flatnonzero(wrong)})


def azimuth(scene: Drawn, corners: Sequence[Array], main: Shown, focus: Array, size: float) -> float:
    """Return the direction [rad] with the fewest fixed bodies between the eye and the middle of the moving ones.

    Of equal directions it is the one nearest across the largest push on the avatar.
    """
    boxes = []
    for k, body in enumerate(scene.bodies):
        if body["role"] == "fixed" and len(corners[k]):
            placed = rotation.rotate(main.orientations[0, k], corners[k]) + main.positions[0, k]
            boxes.append((placed.min(axis=0), placed.max(axis=0)))

    def hidden(turn: float) -> int:
        eye = focus + 1.3 * size * np.array([math.cos(turn), math.sin(turn), 0.45])
        return sum(_between(low, high, eye, focus) for low, high in boxes)

    across = sides(main)
    turned = [side + offset for offset in np.radians([0.0, 15.0, -15.0, 30.0, -30.0, 45.0, -45.0]) for side in across]
    return float(min([*turned, *np.radians(AZIMUTHS)], key=hidden))


def _between(low: Array, high: Array, eye: Array, focus: Array) -> bool:
    """Return whether the box meets the segment from ``eye`` to a little before ``focus``."""
    way = 0.95 * (focus - eye)
    way = np.where(np.abs(way) < 1e-12, 1e-12, way)
    near, far = (low - eye) / way, (high - eye) / way
    return bool(max(np.minimum(near, far).max(), 0.0) <= min(np.maximum(near, far).min(), 1.0))
