"""Postures in and out of an engine, at a start and between frames: invalid ones are refused and change nothing."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from avatarsim.errors import AvatarsimError, InvalidInput, InvalidSample, InvalidScene, StartOverlaps, UnknownName
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from tests.worlds.little_worlds import LIMITS, at, hand, mixed_avatar
from tests.worlds.loaded import DT, loaded

FLOOR = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "wood", (0.0, 0.0, -0.05))


def above_a_floor(preset: str = "default", start: str = "nearest") -> tuple[AvatarsimEngine, Scene]:
    """Return an engine with an avatar of every kind of joint above a floor."""
    scene = Scene("put", (FLOOR,), (mixed_avatar(),), start=within(0.0, 0.5))
    return loaded(scene, preset, start=start), scene


def within(turn: float, height: float) -> TrackerSample:
    """Return a posture within limits, turned about the vertical, at a height [m]."""
    sample = at(rest((mixed_avatar(),)), (0.1 * turn, 0.0, height))
    ball = rotation.between(LIMITS.axis, LIMITS.centre)
    turns = sample.rotations.copy()
    turns[0], turns[1] = rotation.from_rotation_vector((0.0, 0.0, turn)), ball
    return replace(sample, rotations=turns, angles=np.array([0.3 * turn, 0.2, -0.1 * turn]))


def alike(one: TrackerSample, other: TrackerSample) -> bool:
    """Return whether the links of both are at the same places."""
    avatars = (mixed_avatar(),)
    return all(
        np.allclose(np.abs(a), np.abs(b), atol=1e-12)
        for a, b in zip(link_poses(avatars, one), link_poses(avatars, other), strict=True)
    )


def test_what_is_put_is_shown_and_read_again() -> None:
    engine, scene = above_a_floor()
    for turn in (0.5, -1.5, 3.0):
        record = engine.put(within(turn, 0.6))
        positions, turns = link_poses(scene.avatars, within(turn, 0.6))
        assert np.allclose(record.shown.positions[1:], positions, atol=1e-12)
        assert np.allclose(rotation.to_matrix(record.shown.orientations[1:]), rotation.to_matrix(turns), atol=1e-12)
        assert alike(engine.posture(), within(turn, 0.6))
        assert np.array_equal(engine.posture().angles, record.angles)


def test_a_put_avatar_goes_on_as_one_that_was_loaded_there() -> None:
    engine, scene = above_a_floor()
    engine.advance(within(0.2, -0.2), DT)
    engine.put(within(1.0, 0.4))
    fresh = loaded(replace(scene, start=within(1.0, 0.4)))
    for k in range(1, 30):
        target = within(1.0 + 0.05 * k, 0.4 - 0.02 * k)
        one, other = engine.advance(target, DT), fresh.advance(target, DT)
        assert np.allclose(one.shown.positions, other.shown.positions, atol=1e-9)


def test_an_avatar_catches_up_with_a_user_that_stands_elsewhere() -> None:
    engine, _ = above_a_floor()
    engine.put(within(0.0, 0.8), within(0.0, 0.5))
    first = engine.advance(within(0.0, 0.49), DT).shown.positions[1, 2]
    assert 0.5 < first < 0.8
    for k in range(20):
        engine.advance(within(0.0, 0.48 - 0.01 * k), DT)
    assert alike(engine.posture(), within(0.0, 0.29))


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
    engines = [above_a_floor(start="exact")[0] for _ in range(2)]
    for engine in engines:
        for k in range(10):
            engine.advance(within(0.1 * k, 0.5 - 0.05 * k), DT)
    with pytest.raises(error):
        engines[0].put(sample)
    for k in range(10):
        hashes = {engine.advance(within(1.0 + 0.1 * k, 0.0), DT).state_hash() for engine in engines}
        assert len(hashes) == 1


@pytest.mark.parametrize("user", [0, False, "", [], (), {}, np.zeros(0), float("nan"), rest(())])
def test_a_user_that_is_no_sample_is_refused_also_if_false(user: Any) -> None:
    engine, _ = above_a_floor()
    before = engine.snapshot()
    with pytest.raises(InvalidSample):
        engine.put(within(1.0, 0.5), user)
    assert engine.snapshot() == before


def test_a_posture_in_lists_is_put_and_begun_at_as_one_in_arrays() -> None:
    given, (engine, _) = within(0.5, 0.6), above_a_floor()
    lists = replace(given, positions=given.positions.tolist(), rotations=given.rotations.tolist(), angles=given.angles.tolist())
    for begin in (engine.put, engine.reset):
        assert begin(lists).state_hash() == begin(given).state_hash()


def test_scenes_whose_bodies_move_and_the_printed_method_refuse() -> None:
    ball = (Piece(Sphere(0.05)),)
    loose = simulated("ball", ball, "wood", solid(ball, 0.2), (1.0, 0.0, 0.2))
    avatar = hand()
    moving = loaded(Scene("moving", (FLOOR, loose), (avatar,), start=at(rest((avatar,)), (0.0, 0.0, 0.5))))
    for engine in (moving, above_a_floor("paper")[0]):
        with pytest.raises(InvalidInput, match="scene to put avatars in"):
            engine.put(engine.posture())


BALL = (Piece(Sphere(0.1)),)


def test_a_fixed_body_that_is_put_on_pushes_what_it_touches() -> None:
    wall, avatar = fixed("wall", (Piece(Box((0.1, 1.0, 1.0))),), "wood", (-0.5, 0.0, 0.0)), hand(BALL)
    engine = loaded(Scene("pushed", (wall,), (avatar,)), start="exact")
    still = rest((avatar,))
    for x in np.arange(-0.5, -0.1, 4e-5):
        placed = engine.place({"wall": ((float(x), 0.0, 0.0), rotation.IDENTITY)})
        shown = engine.advance(still, DT).shown.positions
        assert placed.shown.positions[0, 0] == shown[0, 0] == x and shown[1, 0] - shown[0, 0] >= 0.15
    assert shown[1, 0] == pytest.approx(0.05, abs=1e-3)
    before = engine.posture()
    with pytest.raises(StartOverlaps, match="wall in hand"):
        engine.place({"wall": ((0.0, 0.0, 0.0), rotation.IDENTITY)})
    with pytest.raises(UnknownName, match="fixed body"):
        engine.place({"hand": ((0.0, 0.0, 0.0), rotation.IDENTITY)})
    with pytest.raises(InvalidSample, match="position of fixed body wall"):
        engine.place({"wall": ((np.nan, 0.0, 0.0), rotation.IDENTITY)})
    with pytest.raises(StartOverlaps):
        engine.put(before, bodies={"wall": ((0.0, 0.0, 0.0), rotation.IDENTITY)})
    record = engine.advance(still, DT)
    assert record.shown.positions[0] == pytest.approx((-0.1, 0.0, 0.0), abs=1e-4)
    # avatar and body at once, where neither alone could go
    moved = engine.put(at(still, (1.0, 0.0, 0.0)), bodies={"wall": ((0.0, 0.0, 0.0), rotation.IDENTITY)})
    assert moved.shown.positions == pytest.approx(np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]))


def test_an_overlapping_start_names_its_pairs_deepest_first() -> None:
    box = fixed("box", (Piece(Box((0.2, 0.2, 0.2))),), "wood", (0.12, 0.0, 0.0))
    near = fixed("near", (Piece(Sphere(0.1)),), "wood", (0.0, 0.16, 0.0))
    far = fixed("far", (Piece(Sphere(0.1)),), "wood", (0.0, 0.0, 5.0))
    scene = Scene("s", (far, box, near), (hand((Piece(Sphere(0.08)),)),))
    with pytest.raises(StartOverlaps) as error:
        loaded(scene, start="exact")
    assert [pair[:2] for pair in error.value.pairs] == [("box", "hand"), ("near", "hand")]
    assert [pair[2] for pair in error.value.pairs] == pytest.approx([0.06, 0.02])
    assert "box in hand by 60 mm" in str(error.value) and "far" not in str(error.value)


def test_many_overlaps_are_counted_not_listed() -> None:
    crowd = tuple(fixed(f"f{k}", BALL, "wood", (0.01 * k, 0.0, 0.0)) for k in range(12))
    with pytest.raises(StartOverlaps, match="and 4 more"):
        loaded(Scene("s", crowd, (hand(),)), start="exact")


def test_pairs_that_are_left_out_may_overlap_at_the_start() -> None:
    inside = fixed("box", (Piece(Box((0.2, 0.2, 0.2))),), "wood")
    engine = loaded(Scene("s", (inside,), (hand(),), exclude=(("box", "hand"),)))
    assert engine.advance(rest((hand(),)), DT).shown.positions.shape == (2, 3)


@pytest.mark.parametrize(("joint", "changed", "says"), [
    (Hinges((Hinge((1.0, 0.0, 0.0), 0.2, 1.0),)), {"angles": np.array([1.5])},
     r"start angle of a hinge of limb \[rad\] is 1.5; valid: 0.2 to 1"),
    (Ball(SwingTwist((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), 0.5, (-0.5, 0.5))),
     {"rotations": np.array([[1.0, 0.0, 0.0, 0.0], [np.cos(0.4), np.sin(0.4), 0.0, 0.0]])},
     "start rotation of limb beyond its swing and twist limits .* is 0.3"),
])
def test_a_start_beyond_a_limit_is_refused_by_name(joint: Joint, changed: dict[str, np.ndarray], says: str) -> None:
    limb = Link("limb", "root", joint, BALL, solid(BALL, 1.0), anchor=(0.0, 0.0, 0.5))
    avatar = Avatar("a", (Link("root", None, Free(), BALL, solid(BALL, 1.0)), limb))
    start: Any = replace(rest((avatar,)), **changed)  # type: ignore[arg-type]
    with pytest.raises(InvalidScene, match=says):
        loaded(Scene("s", avatars=(avatar,), start=start))


def test_a_restored_state_shows_fixed_bodies_where_they_were_put() -> None:
    engine, _ = above_a_floor()
    lower = ((0.0, 0.0, -0.4), (1.0, 0.0, 0.0, 0.0))
    placed, kept = engine.place({"floor": lower}), engine.snapshot()
    other, _ = above_a_floor()
    assert other.restore(kept).state_hash() == placed.state_hash()
    engine.place({"floor": ((0.0, 0.0, -0.6), (1.0, 0.0, 0.0, 0.0))})
    assert engine.restore(kept).state_hash() == placed.state_hash()
    sample = engine.posture()
    assert engine.advance(sample, DT).shown.positions[0, 2] == other.advance(sample, DT).shown.positions[0, 2] == -0.4
