"""Driving through obstacles, as the engine shows it: no part of the avatar overlaps, and its joints keep their limits."""

from collections.abc import Callable

import pytest

from avatarsim.engine import Settings
from avatarsim.live.drive.driver import Driver
from avatarsim.live.stages import stage
from avatarsim.simulator import AvatarsimEngine
from avatarsim.tolerances import JUDGED
from tests.live.drive.stages_driven import DT, excess

LOOSE_ON_FIXED = 2e-6
"""[m] Largest overlap of loose bodies with one another or with fixed ones: the remainder of their position projection."""


def hand_through_the_table(one: Driver, frame: int) -> None:
    """Drag the hand down through the table and into the wall, and make a fist."""
    if frame == 0:
        one.drag("hand/palm", (0.15, 0.0, 0.5))
    if frame == 120:
        one.drag("hand/palm", (0.8, 0.1, 0.7))
    if frame == 200:
        one.release("hand/palm")
    if frame > 200 and frame % 3 == 0:
        one.press("g")



def toys_over(one: Driver, frame: int) -> None:
    """Drag the hand into the dominoes, the tower and the mug."""
    places = {0: (-0.2, -0.28, 0.8), 60: (0.0, -0.28, 0.8), 110: (0, 0.25, 0.85), 150: (0.3, 0.25, 0.85), 200: (0.12, -0.1, 0.8)}
    if frame in places:
        one.drag("hand/palm", places[frame])


def walk_into_things(one: Driver, frame: int) -> None:
    """Walk over a box and through walls, with a hand through the table in the other room."""
    if frame < 150 and frame % 3 == 0:
        one.press("i" if frame < 60 else "l")
    if frame == 150:
        one.drag("human/right_hand", (2.0, -0.9, 0.3))


@pytest.mark.parametrize(("name", "script"), [
    ("hand", hand_through_the_table), ("toys", toys_over), ("gallery", walk_into_things),
])
def test_what_is_shown_never_overlaps(name: str, script: Callable[[Driver, int], None]) -> None:
    scene = stage(name).scene
    one, engine, touched = Driver(scene), AvatarsimEngine(), False
    links = set(scene.names[len(scene.bodies):])
    engine.load(scene, Settings(), DT)
    for frame in range(240):
        script(one, frame)
        record = engine.advance(one.tick(DT), DT)
        assert not {status for status in record.statuses if "overlap" in status or "not finite" in status}
        for contact in engine.contacts(1e-3):
            is_avatars = bool({contact.a, contact.b} & links)
            touched |= is_avatars
            assert contact.gap > -(JUDGED if is_avatars else LOOSE_ON_FIXED), (frame, contact)
        assert excess(scene, engine.posture()) < 1e-6
    assert touched
