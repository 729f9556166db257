"""What a page needs to play a scene again: meshes once, and per engine the poses of what moves, packed small."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from avatarsim.spatial import rotation
from reports.drawing import mesh
from reports.drawing.stills import sides
from reports.reading.kept import Array, Drawn, Shown
from reports.replay import packed
from reports.replay.moments import Kind, Moment, moments, remarks

SEEN = 1e-6
"""Depth [m] from which a pair is marked, the bound on what may be shown."""
MOST_FRAMES = 600
"""States drawn per engine at most: ten seconds; longer scenes leave out states evenly."""
MOST_BYTES = 1_600_000
"""Bytes of all poses of a page before they become text (a third more): with three.js a page stays below 3 MB."""
BYTES_PER_POSE = 14
"""Three places and four parts of a quaternion, 16 bits each."""
AIR = 0.25
"""Share by which the box that holds what is drawn is wider than what our engine and the tracker do; what is thrown farther is
drawn at its edge."""
LEAST = 1.0 / 3.0
"""Least share of the room of the whole motion that a view which follows shows: a fist alone says nothing of what it meets."""
FAR = 0.85
"""The view follows what is driven where that needs less than this share of the room that the whole motion needs."""


def stride(frames: Sequence[int], moving: int) -> int:
    """Every how many-th state is drawn, for engines with so many `frames` and `moving` bodies each."""
    bytes_all = sum(frames) * moving * BYTES_PER_POSE
    return max(1, math.ceil(bytes_all / MOST_BYTES), math.ceil(max(frames, default=1) / MOST_FRAMES))


def replay(
    scene: Drawn, shown: Sequence[Shown], ours: str, depths: Mapping[str, Array] | None = None
) -> dict[str, object] | None:
    """The data of one scene's replay, ready for JSON; None when nothing was recorded. `ours` names the run that the view fits,
    `depths` are the judge's overlaps [m] by run, not a number where it found no pose to judge."""
    engines = [one for one in shown if not one.run.startswith("tracker/")]
    if not shown or not engines:
        return None
    moving = [k for k, body in enumerate(scene.bodies) if body["role"] != "fixed"]
    main = next((one for one in engines if one.run == ours), engines[0])
    links = main.raw_positions.shape[1]
    step = stride([len(one.times) for one in engines] + [len(main.times)] * bool(links), max(1, len(moving)))
    shapes, which = _meshes(scene)
    reach = [float(np.linalg.norm(points, axis=1).max(initial=0.0)) for points, _ in shapes]
    places = [main.positions[:, moving].reshape(-1, 3), main.raw_positions.reshape(-1, 3)]
    low, high = _span(np.concatenate(places), max((reach[which[k]] for k in moving), default=0.1))
    margin = AIR * (high - low) + 0.5
    box = low - margin, high + margin
    followed = list(range(len(scene.bodies) - links, len(scene.bodies))) if links else moving
    names = scene.names_of_links(links)
    worst = {one.run: moments(one, (depths or {}).get(one.run), names) for one in engines}
    # the user too is to be seen, whose place may be far from what is shown
    seen = np.concatenate([main.positions[:, followed], main.raw_positions], axis=1)
    radius = float(0.5 * np.linalg.norm(high - low))
    least = LEAST * radius
    near = max(_near(seen, [reach[which[k]] for k in followed] * (2 if links else 1)), least)
    ghost = _poses(main.raw_positions[::step], main.raw_orientations[::step], *box) if links else None
    return {
        "dt": float(main.times[1] - main.times[0]) * step if len(main.times) > 1 else 1.0 / 60.0,
        "stride": step,
        "low": box[0].tolist(),
        "high": box[1].tolist(),
        "focus": (0.5 * (low + high)).tolist(),
        "radius": radius,
        "followed": followed,
        "near": near,
        "least": least,
        "follow": near < FAR * radius,
        "leader": engines.index(main),
        "reach": [reach[which[k]] for k in followed],
        "opens": opening(engines, worst, ours, step),
        "azimuth": azimuth(scene, shapes, which, main, 0.5 * (low + high), 2.0 * radius, sides(main)),
        "meshes": [{"corners": packed.reals(points), "faces": packed.text(faces.astype(np.uint32))} for points, faces in shapes],
        "bodies": [{"name": body["name"], "role": body["role"], "mesh": which[k]} for k, body in enumerate(scene.bodies)],
        "still": [
            {"body": k, "place": main.positions[0, k].tolist(), "turn": main.orientations[0, k].tolist()}
            for k in range(len(scene.bodies))
            if k not in moving
        ],
        "moving": moving,
        "links": list(range(len(scene.bodies) - links, len(scene.bodies))),
        "ghost": ghost,
        "runs": [
            {
                "run": one.run,
                **_poses(one.positions[::step][:, moving], one.orientations[::step][:, moving], *box),
                "pairs": _pairs(one, step),
                "worst": [{"state": found.state // step, "said": found.said} for found in worst[one.run]],
                "remarks": remarks(one, step),
                "broken": _broken(one, step, (depths or {}).get(one.run)),
            }
            for one in engines
        ],
    }


def _meshes(scene: Drawn) -> tuple[list[mesh.Mesh], list[int]]:
    """The different meshes, and which of them each body has: a heap of 216 equal balls is one mesh."""
    known: dict[str, int] = {}
    shapes: list[mesh.Mesh] = []
    which = []
    for body in scene.bodies:
        key = repr(body["pieces"])
        if key not in known:
            known[key] = len(shapes)
            shapes.append(mesh.body(body["pieces"]))
        which.append(known[key])
    return shapes, which


def _span(places: Array, reach: float) -> tuple[Array, Array]:
    """The box round nearly all places, wider by the `reach` of a body; outliers of a percent do not stretch the view."""
    sound = places[np.isfinite(places).all(axis=1)]
    if not len(sound):
        return np.full(3, -1.0), np.full(3, 1.0)
    return np.percentile(sound, 1.0, axis=0) - reach, np.percentile(sound, 99.0, axis=0) + reach


def _near(positions: Array, reach: Sequence[float]) -> float:
    """Radius [m] of a ball round the middle of the followed bodies (F, m, 3) that holds nearly all of them nearly always."""
    sound = positions[np.isfinite(positions).all(axis=(1, 2))]
    if not sound.size:
        return 1.0
    apart = np.linalg.norm(sound - sound.mean(axis=1, keepdims=True), axis=2) + np.array(reach)
    return float(np.percentile(apart.max(axis=1), 95.0))


def _poses(positions: Array, orientations: Array, low: Array, high: Array) -> dict[str, object]:
    """Positions (F, m, 3) and orientations (F, m, 4) as text."""
    # a body without an orientation is nowhere either
    sound = np.isfinite(orientations).all(axis=-1, keepdims=True)
    positions = np.where(sound, positions, np.nan)
    places = np.stack([packed.codes(positions[..., k], (float(low[k]), float(high[k]))) for k in range(3)], axis=-1)
    return {"frames": len(positions), "places": packed.text(places), "turns": packed.quaternions(orientations)}


def _pairs(one: Shown, step: int) -> list[list[list[float]]]:
    """Per drawn state the overlapping pairs [body, body, depth in mm], those of the worst of the states that it stands for."""
    groups: dict[int, dict[int, list[list[float]]]] = {}
    for frame, first, second, depth in one.pairs:
        if depth > SEEN:
            groups.setdefault(frame // step, {}).setdefault(frame, []).append([first, second, float(f"{1e3 * depth:.3g}")])
    worst = {group: max(states.values(), key=lambda pairs: pairs[0][2]) for group, states in groups.items()}
    return [worst.get(k, []) for k in range(-(-len(one.times) // step))]


FIRST = (Kind.NO_NUMBER, Kind.OVERLAP, Kind.JUMP, Kind.ORIENTATION, Kind.BACK)
"""Kinds of moments on which a page opens, those first that come first; then any other."""


def opening(
    engines: Sequence[Shown], worst: Mapping[str, Sequence[Moment]], ours: str, step: int
) -> dict[str, dict[str, object]]:
    """The drawn states to open on, each with its run: "ours", where our engine looks worst (its overlap, or else its largest jump
    or change of orientation, or else its largest displacement to and fro, or what else there is), and "others", the deepest
    overlap of the others. Without an entry where there is no such moment, or where ours shows nothing."""
    found: dict[str, dict[str, object]] = {}
    own = worst.get(ours, ())
    if own:
        first = min(own, key=lambda one: FIRST.index(one.kind) if one.kind in FIRST else len(FIRST))
        found["ours"] = {"state": first.state // step, "run": ours}
    pairs = [(depth, -frame, one.run) for one in engines if one.run != ours for frame, _, _, depth in one.pairs]
    if pairs:
        _, frame, run = max(pairs)
        found["others"] = {"state": -frame // step, "run": run}
    return found


def _broken(one: Shown, step: int, depth: Array | None) -> list[int]:
    """The drawn states that stand for one in which a pose is no number, or no pose."""
    wrong = ~(np.isfinite(one.positions).all(axis=(1, 2)) & np.isfinite(one.orientations).all(axis=(1, 2)))
    if depth is not None and depth.size == wrong.size:
        wrong |= ~np.isfinite(depth)
    return sorted({int(frame) // step for frame in np.flatnonzero(wrong)})


def azimuth(
    scene: Drawn,
    shapes: Sequence[mesh.Mesh],
    which: Sequence[int],
    main: Shown,
    focus: Array,
    size: float,
    sides: Sequence[float] = (),
) -> float:
    """Return the direction [rad] with the fewest fixed bodies between the eye and the middle of the moving ones.

    Of equal directions it is the one nearest to ``sides``.
    """
    boxes = []
    for k, body in enumerate(scene.bodies):
        points = shapes[which[k]][0]
        if body["role"] == "fixed" and len(points):
            placed = rotation.rotate(main.orientations[0, k], points) + main.positions[0, k]
            boxes.append((placed.min(axis=0), placed.max(axis=0)))
    best, least = 0.0, math.inf
    turned = [side + offset for offset in np.radians([0.0, 15.0, -15.0, 30.0, -30.0, 45.0, -45.0]) for side in sides]
    for turn in (*turned, *np.radians([-60.0, -30.0, -120.0, -90.0, 60.0, 120.0, 0.0, 180.0, 30.0, 150.0])):
        eye = focus + 1.3 * size * np.array([math.cos(turn), math.sin(turn), 0.45])
        hidden = sum(_between(low, high, eye, focus) for low, high in boxes)
        if hidden < least:
            best, least = float(turn), hidden
    return best


def _between(low: Array, high: Array, eye: Array, focus: Array) -> bool:
    """Whether the box meets the segment from `eye` to a little before `focus`."""
    way = 0.95 * (focus - eye)
    way = np.where(np.abs(way) < 1e-12, 1e-12, way)
    near, far = (low - eye) / way, (high - eye) / way
    return bool(max(np.minimum(near, far).max(), 0.0) <= min(np.maximum(near, far).min(), 1.0))


def counts_of(data: Mapping[str, object]) -> int:
    """How many states of the longest run are drawn."""
    runs = data["runs"]
    assert isinstance(runs, list)
    return max(int(run["frames"]) for run in runs)
