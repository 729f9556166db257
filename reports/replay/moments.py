"""Worst moments of each engine in a scene: the states of a replay at which its figures are largest."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from avatarsim.spatial import rotation
from reports.reading.kept import Array, Drawn, Shown
from reports.reading.load import Results, Series
from reports.tables.figures import quantity
from runfiles.visible_motion import FAR, SHAKES, reversals, shaking

LEAST = 1e-6
"""Overlap, or distance from the tracker [m], that is worth a button: the bound on what may be shown."""
LEVER = 0.1
"""Length [m] of a hand or foot: a change of orientation is worth a button if its end moves as far as counts as shaking."""
OVERLAPS = ("residual_overlap_max", "residual_overlap_p95", "residual_overlap_mean")
TIMES = ("frame_time_p95", "frame_time_p99", "frame_time_max")
"""Metrics with a stored number per state, and per timed frame."""
ALIKE = {"tracker_offset_rms": "tracker_offset_max", "reversal_p95": "reversal_max"}
"""Metrics whose worst moment is that of another one."""


class Kind(Enum):
    """Fault of a state."""

    NO_NUMBER = "a pose is no number"
    OVERLAP = "overlap of {figure}"
    APART = "{name} {figure} from its user"
    SHAKES = "{name} shakes by {figure}, frame after frame"
    BACK = "{name} {figure} to and fro over two frames"
    JUMP = "{name} jumps {figure} beyond its user in one frame"
    ORIENTATION = "{name} changes its orientation by {figure} beyond its user in one frame"


@dataclass(frozen=True)
class Moment:
    """A state of a run, counted from 0, and its fault, also in words."""

    state: int
    caption: str
    kind: Kind


@dataclass(frozen=True, eq=False)
class Look:
    """One quantity of the links of a run in each of F+1 states.

    figures  (F+1, L) [m] or [rad]
    least    figure that is worth a button
    seen     figure that is worth a remark
    metric   of its largest figure, "" without one
    remark   on a state, "" without one
    """

    figures: Array
    least: float
    seen: float
    metric: str
    remark: str

    def text(self, figure: float, kind: Kind) -> str:
        """Return a figure with its unit."""
        is_angle = kind is Kind.ORIENTATION
        return quantity(float(np.degrees(figure)) if is_angle else float(figure), "deg" if is_angle else "m")


def looks(one: Shown) -> Mapping[Kind, Look]:
    """Return differences of a recording's links from their targets, 0 where one is no number; nothing without links."""
    count = one.raw_positions.shape[1]
    if not count:
        return {}
    links, turns = one.positions[:, -count:], one.orientations[:, -count:]
    dt = float(one.times[1] - one.times[0]) if len(one.times) > 1 else 1.0
    visible = SHAKES * dt

    def states(per_frame: Array) -> Array:
        return np.concatenate([np.zeros((1, count)), np.nan_to_num(per_frame)])

    with np.errstate(invalid="ignore", over="ignore"):
        back = np.nan_to_num(reversals(links, one.raw_positions))
        steps = [np.linalg.norm(np.diff(places, axis=0), axis=2) for places in (links, one.raw_positions)]
        apart = np.nan_to_num(np.linalg.norm(links - one.raw_positions, axis=2))
        shakes = np.where(shaking(back, dt)[:, None], back, 0.0)
        turned = states(_angles(turns) - _angles(one.raw_orientations))
    beyond = "beyond its user in a frame"
    return {
        Kind.BACK: Look(states(back), visible, visible, "reversal_max", "{} to and fro"),
        Kind.JUMP: Look(states(steps[0] - steps[1]), visible, visible, "link_jump_max", f"{{}} {beyond}"),
        Kind.APART: Look(apart, LEAST, FAR, "tracker_offset_max", "{} from its user"),
        Kind.SHAKES: Look(states(shakes), LEAST, np.inf, "chatter_frames", ""),
        Kind.ORIENTATION: Look(turned, visible / LEVER, visible / LEVER, "", "orientation {} beyond its user's in a frame"),
    }


def _angles(orientations: Array) -> Array:
    """Return the turn [rad] (F, L) from each state to the next of orientations (F+1, L, 4)."""
    between = rotation.multiply(rotation.conjugate(orientations[:-1]), orientations[1:])
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(between[..., 1:], axis=-1), np.abs(between[..., 0])))


def moments(one: Shown, depth: Array | None, names: Sequence[str] = ()) -> tuple[Moment, ...]:
    """Return the first state that is no number, or else the state of each other kind with the largest figure.

    Args:
        one: recording.
        depth: of the judge (F+1,) [m]; without it that of the pairs counts.
        names: of the links: "avatar/link", the first of an avatar its root.
    """
    broken = ~(np.isfinite(one.positions).all(axis=(1, 2)) & np.isfinite(one.orientations).all(axis=(1, 2)))
    if broken.any():
        return (Moment(int(np.argmax(broken)), Kind.NO_NUMBER.value, Kind.NO_NUMBER),)
    depths = np.zeros(len(one.times)) if depth is None or depth.size != len(one.times) else np.nan_to_num(depth, nan=0.0)
    for frame, _, _, deep in one.pairs:
        depths[frame] = max(depths[frame], deep)
    seen, chosen = {Kind.OVERLAP: Look(depths[:, None], LEAST, np.inf, "", ""), **looks(one)}, []
    for kind in (one for one in Kind if one in seen):
        look = seen[kind]
        state, link = np.unravel_index(int(np.argmax(look.figures)), look.figures.shape)
        if look.figures[state, link] > look.least:
            text = kind.value.format(name=called(int(link), names), figure=look.text(look.figures[state, link], kind))
            chosen.append(Moment(int(state), text, kind))
    return tuple(chosen)


def called(link: int, names: Sequence[str]) -> str:
    """Return "root" for the first link of an avatar, "link left_wrist" for another; "a link" where there are no names."""
    if not 0 <= link < len(names):
        return "a link"
    avatar, _, name = names[link].partition("/")
    return "root" if link in roots(names) else f"link {name or avatar}"


def roots(names: Sequence[str]) -> list[int]:
    """Return the places of the links that are the first of their avatar."""
    avatars = [name.partition("/")[0] for name in names]
    return [avatars.index(avatar) for avatar in dict.fromkeys(avatars)]


def instants(one: Shown, scene: Drawn | None) -> Mapping[str, float]:
    """Return the time [s] of the largest figure of each metric of an avatar's looks, where it is above 0."""
    seen = looks(one)
    if not seen or len(one.times) < 2:
        return {}
    names = [] if scene is None else scene.names_of_links(one.raw_positions.shape[1])
    figures = {look.metric: look.figures for look in seen.values() if look.metric}
    figures["root_jump_max"] = seen[Kind.JUMP].figures[:, roots(names)]
    figures["pose_jump_max"] = _joints(one, () if scene is None else scene.parents)
    states = {metric: int(np.argmax(each.max(axis=1))) for metric, each in figures.items() if each.size and each.max() > 0.0}
    return {metric: float(one.times[state]) for metric, state in states.items()}


def _joints(one: Shown, parents: Sequence[int | None]) -> Array:
    """Return the largest turn [rad] (F+1, 1) of a joint shown since the state before, less the largest of the user's.

    A root turns in the world. Empty where the parents are not those of the links.
    """
    count = one.raw_positions.shape[1]
    if len(parents) != count:
        return np.zeros((0, 1))
    turns = []
    for orientations in (one.orientations[:, -count:], one.raw_orientations):
        joints = orientations.copy()
        for link, parent in enumerate(parents):
            if parent is not None:
                joints[:, link] = rotation.multiply(rotation.conjugate(orientations[:, parent]), orientations[:, link])
        turns.append(np.nan_to_num(_angles(joints)).max(axis=1))
    return np.concatenate([[0.0], turns[0] - turns[1]])[:, None]


def remarks(one: Shown, step: int) -> list[tuple[int, str]]:
    """Return (drawn state, words) of visible reversals, jumps, distances and turns, the worst of each ``step`` states."""
    by_state: dict[int, list[str]] = {}
    for kind, look in looks(one).items():
        worst = np.maximum.reduceat(look.figures.max(axis=1), np.arange(0, len(look.figures), step))
        for state in np.flatnonzero(worst > look.seen).tolist():
            by_state.setdefault(state, []).append(look.remark.format(look.text(worst[state], kind)))
    return [(state, ", ".join(texts)) for state, texts in sorted(by_state.items())]


def address(time: float) -> str:
    """Return "#t=0.341667", the part of a page's address that leads to a time [s]."""
    return f"#t={time:.6g}"


def moment(results: Results, scene: str, run: str, metric: str, known: Mapping[str, Mapping[str, float]]) -> str:
    """Return the address of the time of the largest figure of ``run``: ``known`` by scene and metric, or else of its series.

    "" for metrics without either.
    """
    time = known.get(scene, {}).get(ALIKE.get(metric, metric))
    if time is not None:
        return address(time)
    dt, series = results.frame_times.get(scene), results.series.get(scene, {}).get(run)
    if dt is None or series is None:
        return ""
    values, first = _values(series, metric)
    return address(dt * (first + int(np.nanargmax(values)))) if np.isfinite(values).any() else ""


def _values(series: Series, metric: str) -> tuple[Array, int]:
    """Return the series of a metric and the number of its first frame: overlap has the state of the start, times have not."""
    if metric in OVERLAPS:
        return series.overlap, 0
    return (series.frame_time, 1) if metric in TIMES else (np.empty(0), 0)
