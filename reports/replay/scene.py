"""Data of the player for a scene: a view per engine, with its overlaps and its worst moments, and the tracker as the ghost."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from avatarsim.player import payload, surfaces
from avatarsim.spatial import rotation
from reports.drawing.stills import sides
from reports.reading.kept import Array, Drawn, Shown
from reports.replay.moments import Kind, Moment, moments, remarks
from reports.tables.figures import quantity
from runfiles.engines import about, run_label

SEEN = 1e-6
"""Depth [m] from which a pair is marked, the bound on what may be shown."""
MAX_FRAMES = 600
"""States drawn per engine at most: ten seconds; longer scenes leave out states evenly."""
MAX_BYTES = 1_600_000
"""Bytes of all poses of a page before they become text (a third more): a page stays below 2.5 MB."""
BYTES_PER_POSE = 14
"""Three places and four parts of a quaternion, 16 bits each."""
FIRST = (Kind.NO_NUMBER, Kind.OVERLAP, Kind.JUMP, Kind.ORIENTATION, Kind.BACK)
"""Kinds of moments on which a page opens, those first that come first; then any other."""
AZIMUTHS = (-60.0, -30.0, -120.0, -90.0, 60.0, 120.0, 0.0, 180.0, 30.0, 150.0)
"""Directions [deg] of the eye, the preferred one first."""


def stride(frames: Sequence[int], moving: int) -> int:
    """Return every how many-th state is drawn, for engines with so many ``frames`` and ``moving`` bodies each."""
    bytes_all = sum(frames) * moving * BYTES_PER_POSE
    return max(1, math.ceil(bytes_all / MAX_BYTES), math.ceil(max(frames, default=1) / MAX_FRAMES))


def replay(
    name: str, scene: Drawn, shown: Sequence[Shown], ours: str, depths: Mapping[str, Array] | None = None
) -> dict[str, object] | None:
    """Return the data of a replay, ready for JSON; None when nothing was recorded.

    Args:
        name: of the scene.
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
    shapes = {body["pieces"]: surfaces.surface(body["pieces"]) for body in scene.bodies}
    bodies = [payload.BodyMesh(body["role"], shapes[body["pieces"]]) for body in scene.bodies]
    names = scene.names_of_links(count)
    worst = {one.run: moments(one, judged.get(one.run), names) for one in engines}
    ghost = payload.Poses(main.raw_positions[::step], main.raw_orientations[::step])
    dt = float(main.times[1] - main.times[0]) * step if len(main.times) > 1 else 1.0 / 60.0
    return payload.payload(
        bodies, {k: (main.positions[0, k], main.orientations[0, k]) for k in range(len(bodies)) if k not in moving},
        np.asarray(dt * np.arange(max(-(-len(one.times) // step) for one in engines))),
        [_view(one, scene, moving, step, worst[one.run], judged.get(one.run)) for one in engines], engines.index(main),
        ("user", links, ghost) if count else None,
        lambda focus, radius: azimuth(scene, [body.surface[0] for body in bodies], main, focus, 2.0 * radius),
        name=name, calm="no overlap", opens=opening(engines, worst, ours, step),
    )


def _view(
    one: Shown, scene: Drawn, moving: Sequence[int], step: int, worst: Sequence[Moment], depth: Array | None
) -> payload.View:
    """Return the view of an engine, which draws every ``step``-th state."""
    pairs, bodies = _pairs(one, step), scene.bodies
    captions = {state: (payload.MOVES, f"no overlap; {text}") for state, text in remarks(one, step)}
    for state, ((first, second, deep), *_) in pairs.items():
        inner, outer = (second, first) if bodies[first]["role"] == "fixed" else (first, second)
        captions[state] = payload.OVERLAP, f"{quantity(deep, 'm')}: {bodies[inner]['name']} in {bodies[outer]['name']}"
    captions |= dict.fromkeys(_broken(one, step, depth), (payload.OVERLAP, "a pose here is no number"))
    return payload.View(
        run_label(one.run), about(one.run.partition("/")[0]).both,
        payload.Poses(one.positions[::step][:, moving], one.orientations[::step][:, moving]), captions,
        {state: [pair[:2] for pair in of] for state, of in pairs.items()},
        [payload.Moment(moment.state // step, f"{moment.caption}, at {one.times[moment.state]:.4g} s") for moment in worst],
    )


def _pairs(one: Shown, step: int) -> dict[int, list[tuple[int, int, float]]]:
    """Return by drawn state the pairs (body, body, depth) of the state that overlaps most of those that it represents."""
    states = dict[int, list[tuple[int, int, float]]]()
    for frame, first, second, depth in one.pairs:
        if depth > SEEN:
            states.setdefault(frame, []).append((first, second, depth))
    by_state = dict[int, list[tuple[int, int, float]]]()
    for frame, pairs in states.items():
        known = by_state.get(frame // step)
        if known is None or pairs[0][2] > known[0][2]:
            by_state[frame // step] = pairs
    return by_state


def opening(engines: Sequence[Shown], worst: Mapping[str, Sequence[Moment]], ours: str, step: int) -> int:
    """Return the drawn state to open on: the worst moment of the gated engine, by FIRST, else the deepest overlap of others."""
    if own := worst.get(ours, ()):
        return min(own, key=lambda one: FIRST.index(one.kind) if one.kind in FIRST else len(FIRST)).state // step
    pairs = [(depth, -frame) for one in engines if one.run != ours for frame, _, _, depth in one.pairs]
    return -max(pairs)[1] // step if pairs else 0


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
