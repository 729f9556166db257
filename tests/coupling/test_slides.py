"""Slides and couplings under load: a lift carries, coupled jaws squeeze loose bodies, snapshots go on with both."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.scene.avatar import Avatar, Drive, Link
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.joint import Coupling, Rigid, Slide
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine

DT, GAP = 1.0 / 60.0, 1e-3
PLATE, JAW, CRATE = (Piece(Box((0.4, 0.4, 0.04))),), (Piece(Box((0.04, 0.2, 0.2))),), (Piece(Box((0.2, 0.1, 0.1))),)


def crate(x: float, z: float) -> Body:
    """Return a loose crate of 1 kg."""
    return simulated("crate", CRATE, "wood", solid(CRATE, 1.0), (x, 0.0, z))


def lift() -> Avatar:
    """Return a plate that goes up and down, on a drive that sags by 2 mm under a kilogram."""
    links = (
        Link("post", None, Rigid(), (), solid(PLATE, 1.0)),
        Link("plate", "post", Slide((0.0, 0.0, 1.0), 0.0, 0.5), PLATE, solid(PLATE, 2.0), "wood"),
    )
    return Avatar("lift", links, drive=Drive(5000.0, 300.0))


def vice() -> Avatar:
    """Return two jaws on one screw: the right one goes as far as the left one, the other way."""
    links = (
        Link("bed", None, Rigid(), (), solid(JAW, 1.0)),
        Link("left", "bed", Slide((1.0, 0.0, 0.0), 0.0, 0.3), JAW, solid(JAW, 0.5), "wood", anchor=(-0.3, 0.0, 0.5)),
        Link("right", "bed", Slide((1.0, 0.0, 0.0), -0.3, 0.0), JAW, solid(JAW, 0.5), "wood", anchor=(0.3, 0.0, 0.5)),
    )
    return Avatar("vice", links, couplings=(Coupling(1, 0, -1.0),))


def asked(avatar: Avatar, time: float, *angles: float) -> TrackerSample:
    return replace(rest((avatar,)), time=time, angles=avatar.with_followers(np.array(angles)))


def test_a_lift_carries_a_crate_up_and_sags_by_its_weight() -> None:
    avatar, engine = lift(), AvatarsimEngine()
    engine.load(Scene("lift", (crate(0.0, 0.02 + 0.05 + GAP),), (avatar,)), Settings(), DT)
    for frame in range(1, 241):
        record = engine.advance(asked(avatar, frame * DT, min(0.3, 0.2 * frame * DT)), DT)
        assert 0.0 <= record.angles[0] <= 0.5
    assert record.angles[0] == pytest.approx(0.3 - 9.81 / 5000.0, abs=1e-3)
    assert record.shown.positions[0, 2] == pytest.approx(record.angles[0] + 0.07, abs=2e-3)


def closing(frame: int) -> float:
    """Return the target of the left jaw: shut within a second, then open again."""
    return 0.25 * min(1.0, frame / 60.0) if frame < 150 else max(0.0, 0.25 - 0.25 * (frame - 150) / 60.0)


def test_coupled_jaws_squeeze_what_is_loose_and_never_come_apart() -> None:
    avatar, engine = vice(), AvatarsimEngine()
    table = fixed("table", (Piece(Box((1.0, 1.0, 0.1))),), "wood", (0.0, 0.0, 0.35 - GAP))
    engine.load(Scene("vice", (table, crate(0.03, 0.45),), (avatar,)), Settings(), DT)
    least = 1.0
    for frame in range(1, 300):
        record = engine.advance(asked(avatar, frame * DT, closing(frame), 0.0), DT)
        assert record.angles[1] == -record.angles[0] and 0.0 <= record.angles[0] <= 0.3
        least = min(least, 0.3 - record.angles[0] - 0.02)
    # shut on the crate, which they bring to their middle; then open
    assert 0.1 - 1e-3 < least < 0.12
    assert abs(record.shown.positions[1, 0]) < 0.01 and record.angles[0] < 5e-3


@pytest.mark.parametrize("avatar", [lift(), vice()], ids=["lift", "vice"])
def test_a_snapshot_goes_on_to_the_bit(avatar: Avatar) -> None:
    scene, engines = Scene("s", (crate(0.03, 0.6),), (avatar,)), [AvatarsimEngine() for _ in range(2)]
    for engine in engines:
        engine.load(scene, Settings(), DT)
    count = avatar.hinge_count

    def go(engine: AvatarsimEngine, frame: int) -> bytes:
        record = engine.advance(asked(avatar, frame * DT, *([0.1 * np.sin(0.05 * frame) ** 2] * count)), DT)
        return record.shown.positions.tobytes() + record.angles.tobytes()

    for frame in range(1, 60):
        go(engines[0], frame)
    engines[1].restore(engines[0].snapshot())
    assert all(go(engines[0], frame) == go(engines[1], frame) for frame in range(60, 120))
