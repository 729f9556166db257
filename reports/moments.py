"""When does each engine look worst in a scene? The states that its buttons on the page lead to, and what is wrong in each."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from avatarsim.spatial import rotation
from reports.kept import Array, Shown
from reports.wording import quantity
from scenarios.measure.smoothness import FAR, SHAKES, reversals, shaking

LEAST = 1e-6
"""Overlap, or distance from the tracker [m], that is worth a button: the bound on what may be shown."""
LEVER = 0.1
"""Length [m] of a hand or foot: a turn is worth a button if its end moves as far as counts as shaking."""


@dataclass(frozen=True)
class Moment:
    """A state of a run, counted from 0, what is wrong with it in words, and whether it is an overlap."""

    state: int
    said: str
    overlap: bool = False


@dataclass(frozen=True, eq=False)
class Looks:
    """How the links of a run look in each of F+1 states, link by link (F+1, L): distance from the user [m], displacement taken
    back over two frames [m], the same in states that shake, and way [m] and turn [rad] in one frame beyond the user's; `dt` [s]
    of a frame."""

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
        np.nan_to_num(np.linalg.norm(links - one.raw_positions, axis=2)), states(back),
        states(np.where(shaking(back, dt)[:, None], back, 0.0)), states(steps[0] - steps[1]), states(angles[0] - angles[1]), dt,
    )


def _angles(orientations: Array) -> Array:
    """(F, L) turn [rad] from each state to the next of orientations (F+1, L, 4)."""
    between = rotation.multiply(rotation.conjugate(orientations[:-1]), orientations[1:])
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(between[..., 1:], axis=-1), np.abs(between[..., 0])))


def moments(one: Shown, depth: Array | None, names: Sequence[str] = ()) -> tuple[Moment, ...]:
    """The first state that is no number, or else what there is of: the deepest overlap, by the judge's `depth` (F+1,) [m] or by
    the pairs; the state farthest from the raw tracker; the one that shakes most; the largest displacement to and fro; the largest
    jump and the largest turn of a link beyond its user's. `names` of the links: "avatar/link", the first of an avatar its
    root."""
    broken = ~(np.isfinite(one.positions).all(axis=(1, 2)) & np.isfinite(one.orientations).all(axis=(1, 2)))
    if broken.any():
        return (Moment(int(np.argmax(broken)), "a pose is no number"),)
    found = (_overlap(one, depth), *(_moments_of_links(looks(one), names) if one.raw_positions.shape[1] else ()))
    return tuple(moment for moment in found if moment is not None)


def _overlap(one: Shown, depth: Array | None) -> Moment | None:
    depths = np.zeros(len(one.times)) if depth is None or depth.size != len(one.times) else np.nan_to_num(depth, nan=0.0)
    for frame, _, _, deep in one.pairs:
        if 0 <= frame < len(depths):
            depths[frame] = max(depths[frame], deep)
    state = int(np.argmax(depths))
    return Moment(state, f"overlap of {quantity(float(depths[state]), 'm')}", overlap=True) if depths[state] > LEAST else None


def called(link: int, names: Sequence[str]) -> str:
    """"root" for the first link of an avatar, "link left_wrist" for another; "a link" where there are no names."""
    if not 0 <= link < len(names):
        return "a link"
    avatar, _, name = names[link].partition("/")
    first = next(k for k, other in enumerate(names) if other.partition("/")[0] == avatar)
    return "root" if first == link else f"link {name or avatar}"


def _moments_of_links(seen: Looks, names: Sequence[str]) -> tuple[Moment | None, ...]:
    """Farthest from the user, shakes most, goes to and fro most, jumps most, turns most."""
    least = SHAKES * seen.dt
    told = (
        (seen.apart, LEAST, "m", "{who} {figure} from its user"),
        (seen.shakes, LEAST, "m", "{who} shakes by {figure}, frame after frame"),
        (seen.back, least, "m", "{who} {figure} to and fro over two frames"),
        (seen.beyond, least, "m", "{who} jumps {figure} beyond its user in one frame"),
        (seen.turned, least / LEVER, "deg", "{who} turns {figure} beyond its user in one frame"),
    )
    found = []
    for figures, enough, unit, words in told:
        state, link = np.unravel_index(int(np.argmax(figures)), figures.shape) if figures.size else (0, 0)
        most = float(figures[state, link]) if figures.size else 0.0
        shown = quantity(float(np.degrees(most)) if unit == "deg" else most, unit)
        found.append(Moment(int(state), words.format(who=called(int(link), names), figure=shown)) if most > enough else None)
    return tuple(found)


def remarks(one: Shown, step: int) -> list[tuple[int, str]]:
    """(drawn state, words) where a link goes to and fro, jumps or turns by what a screen shows, or is far from its user: what "no
    overlap" alone would hide. Of the states that one drawn state stands for the worst is told."""
    if not one.raw_positions.shape[1]:
        return []
    seen = looks(one)
    least, found = SHAKES * seen.dt, []
    told = ((seen.back, least, "to and fro"), (seen.beyond, least, "beyond its user in a frame"),
            (seen.apart, FAR, "from its user"))
    turned = np.maximum.reduceat(seen.turned.max(axis=1), np.arange(0, len(seen.turned), step))
    worst = [(np.maximum.reduceat(figures.max(axis=1), np.arange(0, len(figures), step)), enough, words)
             for figures, enough, words in told]
    for state in range(len(worst[0][0])):
        said = [f"{quantity(float(figures[state]), 'm')} {words}" for figures, enough, words in worst if figures[state] > enough]
        if turned[state] > least / LEVER:
            said.append(f"turned {quantity(float(np.degrees(turned[state])), 'deg')} beyond its user in a frame")
        if said:
            found.append((state, ", ".join(said)))
    return found
