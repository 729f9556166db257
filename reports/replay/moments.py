"""Worst moments of each engine in a scene: the states that its buttons on the page lead to, and what is wrong in each.

Argmax of what a run kept over time: the moment of a replay at which a figure of one engine in one scene is largest.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
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


class Kind(Enum):
    """What is wrong in a state."""

    NO_NUMBER = "a pose is no number"
    OVERLAP = "overlap of {figure}"
    APART = "{name} {figure} from its user"
    SHAKES = "{name} shakes by {figure}, frame after frame"
    BACK = "{name} {figure} to and fro over two frames"
    JUMP = "{name} jumps {figure} beyond its user in one frame"
    ORIENTATION = "{name} changes its orientation by {figure} beyond its user in one frame"


@dataclass(frozen=True)
class Moment:
    """A state of a run, counted from 0, and what is wrong with it, in words too."""

    state: int
    said: str
    kind: Kind


@dataclass(frozen=True, eq=False)
class Looks:
    """How the links of a run look in each of F+1 states, link by link (F+1, L): distance from the user [m], displacement taken
    back over two frames [m], the same in states that shake, and way [m] and change of orientation [rad] in one frame beyond the
    user's; `dt` [s] of a frame."""

    apart: Array
    back: Array
    shakes: Array
    beyond: Array
    turned: Array
    dt: float


def looks(one: Shown) -> Looks:
    """Finite differences of a recording's links against their targets'; what is no number counts as 0."""
    with np.errstate(invalid="ignore", over="ignore"):
        return _looks(one)


def _looks(one: Shown) -> Looks:
    count = one.raw_positions.shape[1]
    links, turns = one.positions[:, -count:], one.orientations[:, -count:]
    dt = float(one.times[1] - one.times[0]) if len(one.times) > 1 else 1.0

    def states(per_frame: Array) -> Array:
        return np.concatenate([np.zeros((1, count)), np.nan_to_num(per_frame)])

    back = np.nan_to_num(reversals(links, one.raw_positions))
    steps = [np.linalg.norm(np.diff(places, axis=0), axis=2) for places in (links, one.raw_positions)]
    angles = [_angles(orientations) for orientations in (turns, one.raw_orientations)]
    return Looks(
        np.nan_to_num(np.linalg.norm(links - one.raw_positions, axis=2)),
        states(back),
        states(np.where(shaking(back, dt)[:, None], back, 0.0)),
        states(steps[0] - steps[1]),
        states(angles[0] - angles[1]),
        dt,
    )


def _angles(orientations: Array) -> Array:
    """(F, L) turn [rad] from each state to the next of orientations (F+1, L, 4)."""
    between = rotation.multiply(rotation.conjugate(orientations[:-1]), orientations[1:])
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(between[..., 1:], axis=-1), np.abs(between[..., 0])))


def moments(one: Shown, depth: Array | None, names: Sequence[str] = ()) -> tuple[Moment, ...]:
    """The first state that is no number, or else what there is of: the deepest overlap, by the judge's `depth` (F+1,) [m] or by
    the pairs; the state farthest from the raw tracker; the one that shakes most; the largest displacement to and fro; the largest
    jump and the largest change of orientation of a link beyond its user's. `names` of the links: "avatar/link", the first of an
    avatar its root."""
    broken = ~(np.isfinite(one.positions).all(axis=(1, 2)) & np.isfinite(one.orientations).all(axis=(1, 2)))
    if broken.any():
        return (Moment(int(np.argmax(broken)), Kind.NO_NUMBER.value, Kind.NO_NUMBER),)
    found = (_overlap(one, depth), *(_moments_of_links(looks(one), names) if one.raw_positions.shape[1] else ()))
    return tuple(moment for moment in found if moment is not None)


def _overlap(one: Shown, depth: Array | None) -> Moment | None:
    depths = np.zeros(len(one.times)) if depth is None or depth.size != len(one.times) else np.nan_to_num(depth, nan=0.0)
    for frame, _, _, deep in one.pairs:
        if 0 <= frame < len(depths):
            depths[frame] = max(depths[frame], deep)
    state = int(np.argmax(depths))
    said = Kind.OVERLAP.value.format(figure=quantity(float(depths[state]), "m"))
    return Moment(state, said, Kind.OVERLAP) if depths[state] > LEAST else None


def called(link: int, names: Sequence[str]) -> str:
    """ "root" for the first link of an avatar, "link left_wrist" for another; "a link" where there are no names."""
    if not 0 <= link < len(names):
        return "a link"
    avatar, _, name = names[link].partition("/")
    return "root" if link in roots(names) else f"link {name or avatar}"


def roots(names: Sequence[str]) -> tuple[int, ...]:
    """The places of the links that are the first of their avatar."""
    first: dict[str, int] = {}
    for link, name in enumerate(names):
        first.setdefault(name.partition("/")[0], link)
    return tuple(first.values())


def _moments_of_links(seen: Looks, names: Sequence[str]) -> tuple[Moment | None, ...]:
    """Farthest from the user, shakes most, goes to and fro most, jumps most, changes its orientation most."""
    least = SHAKES * seen.dt
    told = (
        (seen.apart, LEAST, "m", Kind.APART),
        (seen.shakes, LEAST, "m", Kind.SHAKES),
        (seen.back, least, "m", Kind.BACK),
        (seen.beyond, least, "m", Kind.JUMP),
        (seen.turned, least / LEVER, "deg", Kind.ORIENTATION),
    )
    found = []
    for figures, enough, unit, kind in told:
        state, link = np.unravel_index(int(np.argmax(figures)), figures.shape) if figures.size else (0, 0)
        most = float(figures[state, link]) if figures.size else 0.0
        shown = quantity(float(np.degrees(most)) if unit == "deg" else most, unit)
        said = kind.value.format(name=called(int(link), names), figure=shown)
        found.append(Moment(int(state), said, kind) if most > enough else None)
    return tuple(found)


def states_of_metrics(one: Shown, names: Sequence[str], parents: Sequence[int | None] = ()) -> Mapping[str, int]:
    """The state in which each metric of how an avatar looks has its largest figure, of those that have one above 0. `names` of
    the links as for `moments`; `parents`: of each link its parent's place among them, without which no joint is known."""
    if not one.raw_positions.shape[1] or len(one.times) < 2:
        return {}
    seen = looks(one)
    figures = {
        "link_jump_max": seen.beyond,
        "root_jump_max": seen.beyond[:, list(roots(names))],
        "reversal_max": seen.back,
        "chatter_frames": seen.shakes,
        "tracker_offset_max": seen.apart,
        "pose_jump_max": _joints(one, parents),
    }
    return {metric: int(np.argmax(each.max(axis=1))) for metric, each in figures.items() if each.size and each.max() > 0.0}


def _joints(one: Shown, parents: Sequence[int | None]) -> Array:
    """(F+1, 1) the largest turn [rad] of a joint shown, from the state before, less the largest of the user's; a root turns in
    the world. Empty where the joints are not those of the links."""
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
    """(drawn state, words) where a link goes to and fro, jumps or changes its orientation by what a screen shows, or is far from
    its user: what "no overlap" alone would hide. Of the states that one drawn state stands for the worst is told."""
    if not one.raw_positions.shape[1]:
        return []
    seen = looks(one)
    least, found = SHAKES * seen.dt, []
    told = (
        (seen.back, least, "to and fro"),
        (seen.beyond, least, "beyond its user in a frame"),
        (seen.apart, FAR, "from its user"),
    )
    turned = np.maximum.reduceat(seen.turned.max(axis=1), np.arange(0, len(seen.turned), step))
    worst = [
        (np.maximum.reduceat(figures.max(axis=1), np.arange(0, len(figures), step)), enough, words)
        for figures, enough, words in told
    ]
    for state in range(len(worst[0][0])):
        said = [f"{quantity(float(figures[state]), 'm')} {words}" for figures, enough, words in worst if figures[state] > enough]
        if turned[state] > least / LEVER:
            said.append(f"orientation {quantity(float(np.degrees(turned[state])), 'deg')} beyond its user's in a frame")
        if said:
            found.append((state, ", ".join(said)))
    return found


OVERLAPS = ("residual_overlap_max", "residual_overlap_p95", "residual_overlap_mean")
TIMES = ("frame_time_p95", "frame_time_p99", "frame_time_max")
"""Metrics of which a run keeps a number per state, and per timed frame: what belongs to the largest is the moment to look at."""

WAITS = ("waiting", "planning")
"""Counts of frames in which an avatar is held off its user and no path is known; a wait is broken by neither's becoming the
other."""


@dataclass(frozen=True)
class Instants:
    """Of one run in one scene the times [s] at which figures are largest, by metric, and its longest wait: (length, begin) [s],
    None where it never waits."""

    at: Mapping[str, float] = field(default_factory=dict)
    wait: tuple[float, float] | None = None


def instants(one: Shown, scene: Drawn | None) -> Instants:
    """Those that a recording tells."""
    names = [] if scene is None else scene.names_of_links(one.raw_positions.shape[1])
    states = states_of_metrics(one, names, () if scene is None else scene.parents)
    return Instants({metric: float(one.times[state]) for metric, state in states.items()}, _longest_wait(one))


def _longest_wait(one: Shown) -> tuple[float, float] | None:
    """Of the stretches of frames in which an avatar waits, or a path for it is sought, the longest: how long it is and when it
    begins [s]."""
    counted = [np.asarray(one.counts[name]) > 0 for name in WAITS if len(one.counts.get(name, ())) == len(one.times)]
    if len(one.times) < 2 or not np.any(counted):
        return None
    edges = np.flatnonzero(np.diff(np.concatenate([[False], np.any(counted, axis=0), [False]])))
    begins, ends = edges[::2], edges[1::2]
    longest = int(np.argmax(ends - begins))
    dt = float(one.times[1] - one.times[0])
    return dt * int(ends[longest] - begins[longest]), float(one.times[begins[longest]])


def address(time: float) -> str:
    """ "#t=0.341667": the part of a page's address that leads to a time [s]."""
    return f"#t={time:.6g}"


def moment(results: Results, scene: str, run: str, metric: str, known: Mapping[str, Instants] | None = None) -> str:
    """The address of the time at which a figure of `run` is largest: by what is `known` of ours in each scene, else by the series
    that the run kept; "" for other metrics and where neither has it."""
    time = known[scene].at.get(metric) if known and scene in known else None
    if time is not None:
        return address(time)
    dt = results.frame_times.get(scene)
    series = results.series.get(scene, {}).get(run)
    if dt is None or series is None:
        return ""
    values, first = _values(series, metric)
    return address(dt * (first + int(np.nanargmax(values)))) if np.isfinite(values).any() else ""


def _values(series: Series, metric: str) -> tuple[Array, int]:
    """The series behind a metric and the number of its first frame: overlap has the state of the start, times have not."""
    if metric in OVERLAPS:
        return series.overlap, 0
    return (series.frame_time, 1) if metric in TIMES else (np.empty(0), 0)
