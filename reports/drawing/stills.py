"""One scene in several engines at one instant, as small pictures: bodies that overlap are red."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from reports.drawing.thumbnail import framed, thumbnail
from reports.reading.kept import Drawn, Shown
from reports.tables.figures import quantity
from runfiles.engines import run_label

VISIBLE = 1e-6
"""Depth [m] from which a body is red."""

CLEAR = 1e-3
"""Depth or distance [m] that is seen in a picture."""


def instant(shown: Sequence[Shown], gated: str) -> int:
    """Return the state in which most engines but the gated one overlap clearly, and deepest; the middle where none does."""
    states = min(len(one.times) for one in shown)
    depths = np.zeros((len(shown), states))
    for k, one in enumerate(shown):
        for frame, _, _, depth in one.pairs if one.run != gated else ():
            if frame < states:
                depths[k, frame] = max(depths[k, frame], depth)
    order = np.lexsort((np.arange(states)[::-1], depths.sum(axis=0), (depths > CLEAR).sum(axis=0)))
    return int(order[-1]) if depths.any() else states // 2


def sides(main: Shown) -> tuple[float, ...]:
    """Return the two azimuths [rad] across the largest push on the avatar away from its user; none without a push."""
    links = main.raw_positions.shape[1]
    pushes = (main.positions[:, -links:] - main.raw_positions).sum(axis=1)[:, :2] if links else np.zeros((1, 2))
    sizes = np.nan_to_num(np.hypot(pushes[:, 0], pushes[:, 1]), nan=0.0, posinf=0.0)
    state = int(np.argmax(sizes))
    if sizes[state] < CLEAR:
        return ()
    side = math.atan2(pushes[state, 1], pushes[state, 0]) + 0.5 * math.pi
    return side, side - math.pi


@dataclass(frozen=True)
class Stills:
    """Pictures of one instant: its time [s], and (label, SVG, caption) per engine."""

    time: float
    pictures: Sequence[tuple[str, str, str]]


def stills(scene: Drawn, shown: Sequence[Shown], gated: str, turn: float) -> Stills:
    """Return pictures of all engines at one instant, of one part of the scene, from the azimuth ``turn`` [rad]."""
    state = instant(shown, gated)
    main = next((one for one in shown if one.run == gated), shown[0])
    view, made = framed(scene, main, state, turn), []
    for one in shown:
        pairs = [(first, second, depth) for frame, first, second, depth in one.pairs if frame == state and depth > VISIBLE]
        red = {body for pair in pairs for body in pair[:2] if scene.bodies[body]["role"] != "fixed"}
        bodies = [{**body, "role": "overlapping"} if k in red else body for k, body in enumerate(scene.bodies)]
        deepest, ever = max((depth for *_, depth in pairs), default=0.0), max((depth for *_, depth in one.pairs), default=0.0)
        label, caption = run_label(one.run), f"overlap {quantity(deepest, 'm', 2)}, at most {quantity(ever, 'm', 2)}"
        text = f"{label} at {float(one.times[state]):.3g} s, {caption}."
        marked = replace(scene, bodies=bodies)
        picture = thumbnail(marked, one, state, turn, text, view) if np.isfinite(one.positions[state]).any() else ""
        made.append((label, picture, caption))
    return Stills(float(main.times[state]), made)
