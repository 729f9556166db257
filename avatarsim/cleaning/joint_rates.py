"""Limits of speed and acceleration of joints, from the user and from the file, as one number per group of degrees of freedom."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.coordinates import Coordinates, Slot
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.ik.rate_limits import degree_groups
from avatarsim.model.world import World
from avatarsim.scene.checks import listed, positive

Array = NDArray[np.float64]

Rate = float | tuple[float, float] | None
"""Limit of a joint [rad/s, or rad/s^2; of a slide m/s, m/s^2]; of a free one a pair, of its translation and its rotation, or one
number for both; None: no limit."""

Rates = float | Mapping[str, Rate] | Sequence[Rate] | Array | str | None
"""Limits of all joints: one number for each, numbers by the joints' names, or in their order; "file": what the file states."""

FILE = "file"
"""Value that selects the limits that the file states."""


def speeds_of(limits: Rates, coordinates: Coordinates, world: World) -> Array:
    """Return speed limits (ng) of the groups of degrees of freedom [rad/s, m/s], infinite where there is none.
    "file": those of the file, none where it states no speed; a root or a ball, for which no file states one, is not limited then.

    Raises InvalidInput and UnknownName for limits that do not fit, and InvalidInput where a joint has no speed in the file while
    others have."""
    stated = {slot.name: slot.speed for slot in _moving(coordinates) if slot.speed > 0.0}
    if isinstance(limits, str) and limits == FILE:
        if not stated:
            return _by_groups({}, coordinates, world)
        rates: dict[str, Rate] = {slot.name: stated.get(slot.name) for slot in _moving(coordinates)}
        missing = [slot.name for slot in _moving(coordinates) if slot.kind not in ("free", "ball") and slot.name not in stated]
        if missing:
            valid = f"a velocity of each joint in the file; speed_limits={{{missing[0]!r}: ...}} adds it, None limits nothing"
            raise InvalidInput("speed limits of the file, of joint", ", ".join(missing), valid)
        return _by_groups(rates, coordinates, world)
    return _by_groups(_named("speed limits", limits, coordinates, stated), coordinates, world)


def accelerations_of(limits: Rates, coordinates: Coordinates, world: World) -> Array:
    """Return acceleration limits (ng) of the groups of degrees of freedom [rad/s^2, m/s^2]. Raises as `speeds_of` does."""
    if isinstance(limits, str) and limits == FILE:
        raise InvalidInput("acceleration limits", limits, "numbers: no file states them")
    return _by_groups(_named("acceleration limits", limits, coordinates, {}), coordinates, world)


def _moving(coordinates: Coordinates) -> list[Slot]:
    return [slot for slot in coordinates.slots if slot.kind != "fixed"]


def _named(thing: str, limits: Rates, coordinates: Coordinates, stated: Mapping[str, float]) -> Mapping[str, Rate]:
    """Return the limits by the joints' names."""
    names = [slot.name for slot in _moving(coordinates)]
    if isinstance(limits, np.ndarray):
        limits = limits.tolist()
    if limits is None:
        return {}
    if isinstance(limits, Mapping):
        for name in limits:
            if name not in names:
                raise UnknownName(f"joint of the {thing}", str(name), names)
        missing = [name for name in names if name not in limits and name not in stated]
        if missing:
            raise InvalidInput(f"{thing} without joint", ", ".join(missing), "a number of each joint; None: no limit")
        return {**stated, **limits}
    if isinstance(limits, Sequence) and not isinstance(limits, str):
        if len(limits) != len(names):
            raise InvalidInput(f"number of {thing}", len(limits), f"{len(names)}, one a joint: {', '.join(names)}")
        return dict(zip(names, limits, strict=True))
    number = positive(thing, limits, InvalidInput)
    return dict.fromkeys(names, number)


def _by_groups(rates: Mapping[str, Rate], coordinates: Coordinates, world: World) -> Array:
    """Return one number per group of degrees of freedom."""
    groups = degree_groups(world.skeleton)
    found = np.full(len(groups), np.inf)
    of_degree = {first: g for g, (first, _, _, _) in enumerate(groups)}
    for slot in _moving(coordinates):
        rate = rates.get(slot.name)
        if rate is None:
            continue
        first = int(world.hinges[slot.hinge] if slot.hinge >= 0 else world.skeleton.first_dof[slot.link])
        of = f"limit of joint {slot.name}"
        if slot.kind == "free":
            both = listed(rate)
            both = both * 2 if len(both) == 1 else both
            if len(both) != 2:
                raise InvalidInput(of, rate, "one number, or a pair: of its translation and of its rotation")
            for k, one in enumerate(both):
                found[of_degree[first + 3 * k]] = np.inf if one is None else positive(of, one, InvalidInput)
        else:
            found[of_degree[first]] = positive(of, rate, InvalidInput)
    # a leader may go as fast as its followers may
    for (follower, leader), (ratio, _) in zip(world.skeleton.follow.tolist(), world.skeleton.ratio.tolist(), strict=True):
        if ratio != 0.0:
            found[of_degree[leader]] = min(found[of_degree[leader]], found[of_degree[follower]] / abs(ratio))
    return found
