"""Scenarios of loose bodies and of led hands, and the regions that they share."""

from collections.abc import Callable, Iterable
from typing import Unpack

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import TABLE_1, Body, PairTable
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import EARTH, Scene
from scenarios.motion.rigid_hands import Places, hands_at, led
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, RENDERED, Fields, Region, Scenario


def above(height: float, *bodies: str, reason: str = "nothing falls through the floor") -> Region:
    """Return the region above a `height` [m]."""
    return Region(bodies, (-INFINITE, -INFINITE, height), (INFINITE, INFINITE, INFINITE), reason)


def before(x: float, *bodies: str, reason: str = "nothing goes through the wall; it cannot be walked round") -> Region:
    """Return the region in which the first coordinate is below `x` [m]."""
    return Region(bodies, (-INFINITE, -INFINITE, -INFINITE), (x, INFINITE, INFINITE), reason)


def each_alone(names: Iterable[str]) -> tuple[tuple[str], ...]:
    """Return groups of one body each, as a scenario's `expects` takes them."""
    return tuple((name,) for name in names)


def undriven(
    name: str, title: str, judged: str, bodies: Callable[[], Iterable[Body]], materials: PairTable = TABLE_1, *,
    gravity: Vector = EARTH, **fields: Unpack[Fields],
) -> Scenario:
    """Return a scene of fixed and loose bodies without a user."""
    motion = untracked(fields.get("dt", RENDERED))
    return Scenario(
        name, title, judged, lambda: Scene(name, tuple(bodies()), materials=materials, gravity=gravity), motion, **fields
    )


def led_hands(
    name: str, title: str, judged: str, bodies: Callable[[], Iterable[Body]], hands: Callable[[], tuple[Avatar, ...]],
    places: Places, materials: PairTable = TABLE_1, **fields: Unpack[Fields],
) -> Scenario:
    """Return a scene of bodies, and of rigid hands whose users are at `places`."""
    return Scenario(
        name, title, judged, lambda: Scene(name, tuple(bodies()), hands(), materials, start=hands_at(places(0.0))), led(places),
        **fields,
    )
