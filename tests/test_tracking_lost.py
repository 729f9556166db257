"""Frames without a sample: avatars stay, the record reports it, and they catch up with tracking once it is back."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import InvalidSample
from avatarsim.many_worlds import advance_many
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.settings import PostureSettings
from tests.worlds.little_worlds import at, hand, mixed_avatar
from tests.worlds.loaded import DT, loaded

BALL = (Piece(Sphere(0.1)),)
FLOOR = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "wood", (0.0, 0.0, -0.05))
LOST, FASTEST = 20, PostureSettings().catch_up_move


def user(avatar: Avatar, x: float, z: float = 0.5) -> TrackerSample:
    return at(rest((avatar,)), (x, 0.0, z))


def scene(avatar: Avatar, *loose: Body) -> Scene:
    return Scene("lost", (FLOOR, *loose), (avatar,), start=user(avatar, 0.0), gravity=(0.0, 0.0, 0.0))


@pytest.mark.parametrize("avatar", [hand(BALL), mixed_avatar()])
def test_an_avatar_stays_while_lost_and_returns_in_its_budget(avatar: Avatar) -> None:
    engine = loaded(scene(avatar))
    for _ in range(5):
        held = engine.advance(user(avatar, 0.0), DT)
    for _ in range(LOST):
        record = engine.advance(None, DT)
        assert record.statuses["tracking_lost"] == 1
        assert record.shown.positions == pytest.approx(held.shown.positions, abs=1e-9)
    last, far = record.shown.positions[1, 0], 1.0
    for k in range(240):
        record = engine.advance(user(avatar, far + 1e-3 * np.sin(0.3 * k)), DT)
        assert "tracking_lost" not in record.statuses
        step, last = abs(record.shown.positions[1, 0] - last), record.shown.positions[1, 0]
        assert step <= FASTEST * DT + 2e-3
    assert last == pytest.approx(far, abs=5e-3)


def test_an_avatar_in_contact_stays_in_contact() -> None:
    avatar = hand(BALL)
    engine = loaded(scene(avatar))
    for k in range(60):
        engine.advance(user(avatar, 0.0, 0.5 - 0.01 * k), DT)
    held = engine.posture().positions[0]
    for _ in range(LOST):
        engine.advance(None, DT)
    assert engine.posture().positions[0] == pytest.approx(held, abs=1e-4)


def test_a_tracker_that_jumps_after_a_loss_strikes_nothing() -> None:
    avatar = hand(BALL)
    ball = simulated("ball", BALL, "wood", solid(BALL, 0.2), (0.6, 0.0, 0.5))
    speeds = []
    for is_lost in (True, False):
        engine = loaded(scene(avatar, ball))
        for _ in range(3):
            engine.advance(None if is_lost else user(avatar, 0.0), DT)
        record = engine.advance(user(avatar, 0.55), DT)
        speeds.append(np.abs(record.shown.velocities[1]).max())
    assert speeds[0] < 0.5 * speeds[1]


def test_many_worlds_and_a_restored_one_go_on_alike() -> None:
    avatar = mixed_avatar()
    engines = [loaded(scene(avatar)) for _ in range(3)]
    samples = [user(avatar, 0.01), None, None, user(avatar, 0.4), user(avatar, 0.41)]
    for k, sample in enumerate(samples):
        one = engines[0].advance(sample, DT)
        (many,) = advance_many([engines[1]], [sample], DT)
        again = engines[2].advance(sample, DT)
        assert one.state_hash() == many.state_hash() == again.state_hash()
        assert dict(one.statuses) == dict(many.statuses)
        if k == 2:
            kept = engines[2].snapshot()
            engines[2] = loaded(scene(avatar))
            engines[2].restore(kept)


def test_a_bad_sample_changes_nothing_while_tracking_is_lost() -> None:
    avatar = hand(BALL)
    engine = loaded(scene(avatar))
    engine.advance(None, DT)
    before = engine.snapshot()
    with pytest.raises(InvalidSample):
        engine.advance(replace(user(avatar, 0.0), positions=np.full((1, 3), np.nan)), DT)
    assert engine.snapshot() == before


def test_a_scene_without_avatars_needs_no_sample() -> None:
    ball = simulated("ball", BALL, "wood", solid(BALL, 0.2), (0.0, 0.0, 1.0))
    engine = loaded(Scene("free", (ball,)))
    assert engine.advance(None, DT).shown.positions[0, 2] < 1.0
