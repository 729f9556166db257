"""Postures in and out of an engine: what is put is what is shown, what cannot be shown is refused and changes nothing."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError, InvalidInput, InvalidSample, InvalidScene, StartOverlaps
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from tests.worlds.little_worlds import LIMITS, at, hand, mixed_avatar

DT = 1.0 / 60.0
FLOOR = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "wood", (0.0, 0.0, -0.05))


def loaded(preset: str = "default") -> tuple[AvatarsimEngine, Scene]:
    """An engine with an avatar of every kind of joint above a floor."""
    avatar = mixed_avatar()
    engine, scene = AvatarsimEngine(), Scene("put", (FLOOR,), (avatar,), start=within(0.0, 0.5))
    engine.load(scene, Settings(preset), DT)
    return engine, scene


def within(turn: float, height: float) -> TrackerSample:
    """A posture within limits, turned about the vertical, at a height [m]."""
    sample = at(rest((mixed_avatar(),)), (0.1 * turn, 0.0, height))
    ball = rotation.between(LIMITS.axis, LIMITS.centre)
    turns = sample.rotations.copy()
    turns[0], turns[1] = rotation.from_rotation_vector((0.0, 0.0, turn)), ball
    return replace(sample, rotations=turns, angles=np.array([0.3 * turn, 0.2, -0.1 * turn]))


def alike(one: TrackerSample, other: TrackerSample) -> bool:
    """Whether the links of both are at the same places."""
    avatars = (mixed_avatar(),)
    return all(
        np.allclose(np.abs(a), np.abs(b), atol=1e-12)
        for a, b in zip(link_poses(avatars, one), link_poses(avatars, other), strict=True)
    )


def test_what_is_put_is_shown_and_read_again() -> None:
    engine, scene = loaded()
    for turn in (0.5, -1.5, 3.0):
        record = engine.put(within(turn, 0.6))
        positions, turns = link_poses(scene.avatars, within(turn, 0.6))
        assert np.allclose(record.shown.positions[1:], positions, atol=1e-12)
        assert np.allclose(rotation.to_matrix(record.shown.orientations[1:]), rotation.to_matrix(turns), atol=1e-12)
        assert alike(engine.posture(), within(turn, 0.6))
        assert np.array_equal(engine.posture().angles, record.angles)


def test_a_put_avatar_goes_on_as_one_that_was_loaded_there() -> None:
    engine, scene = loaded()
    engine.advance(within(0.2, -0.2), DT)
    engine.put(within(1.0, 0.4))
    fresh = AvatarsimEngine()
    fresh.load(replace(scene, start=within(1.0, 0.4)), Settings(), DT)
    for k in range(1, 30):
        target = within(1.0 + 0.05 * k, 0.4 - 0.02 * k)
        one, other = engine.advance(target, DT), fresh.advance(target, DT)
        assert np.allclose(one.shown.positions, other.shown.positions, atol=1e-9)


def test_an_avatar_catches_up_with_a_user_that_stands_elsewhere() -> None:
    engine, _ = loaded()
    engine.put(within(0.0, 0.8), within(0.0, 0.5))
    first = engine.advance(within(0.0, 0.49), DT).shown.positions[1, 2]
    assert 0.5 < first < 0.8
    for k in range(10):
        engine.advance(within(0.0, 0.48 - 0.01 * k), DT)
    assert alike(engine.posture(), within(0.0, 0.39))


@pytest.mark.parametrize(
    "sample, error",
    [
        (within(0.0, -0.1), StartOverlaps),
        (replace(within(0.0, 0.5), angles=np.array([2.5, 0.0, 0.0])), InvalidScene),
        (replace(within(0.0, 0.5), angles=np.zeros(2)), InvalidSample),
        (replace(within(0.0, 0.5), positions=np.full((5, 3), np.nan)), InvalidSample),
        (replace(within(0.0, 0.5), positions=np.full((5, 3), 1e9)), InvalidSample),
    ],
)
def test_what_cannot_be_shown_is_refused_and_changes_nothing(sample: TrackerSample, error: type[AvatarsimError]) -> None:
    engines = [loaded()[0] for _ in range(2)]
    for engine in engines:
        for k in range(10):
            engine.advance(within(0.1 * k, 0.5 - 0.05 * k), DT)
    with pytest.raises(error):
        engines[0].put(sample)
    for k in range(10):
        hashes = {engine.advance(within(1.0 + 0.1 * k, 0.0), DT).state_hash() for engine in engines}
        assert len(hashes) == 1


@pytest.mark.parametrize("user", [0, False, "", [], (), {}, np.zeros(0), float("nan"), rest(())])
def test_a_user_that_is_no_sample_is_refused_also_if_false(user: object) -> None:
    engine, _ = loaded()
    before = engine.snapshot()
    with pytest.raises(InvalidSample):
        engine.put(within(1.0, 0.5), user)
    assert engine.snapshot() == before


def test_a_posture_in_lists_is_put_and_begun_at_as_one_in_arrays() -> None:
    given, (engine, _) = within(0.5, 0.6), loaded()
    lists = replace(given, positions=given.positions.tolist(), rotations=given.rotations.tolist(), angles=given.angles.tolist())
    for begin in (engine.put, engine.reset):
        assert begin(lists).state_hash() == begin(given).state_hash()


def test_scenes_whose_bodies_move_and_the_printed_method_refuse() -> None:
    ball = (Piece(Sphere(0.05)),)
    loose = simulated("ball", ball, "wood", solid(ball, 0.2), (1.0, 0.0, 0.2))
    avatar = hand()
    moving = AvatarsimEngine()
    moving.load(Scene("moving", (FLOOR, loose), (avatar,), start=at(rest((avatar,)), (0.0, 0.0, 0.5))), Settings(), DT)
    for engine in (moving, loaded("paper")[0]):
        with pytest.raises(InvalidInput, match="scene to put avatars in"):
            engine.put(engine.posture())
