"""Starts that overlap: where avatars and loose bodies begin, the record's report, and refused starts."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.errors import StartOverlaps
from avatarsim.many_worlds import advance_many
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import Coupling, Hinge, Hinges, Rigid, Slide
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.scene.tracker import rest
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog
from tests.worlds.little_worlds import Y, at, hand, mixed_avatar, turned
from tests.worlds.loaded import DT, loaded

BALL, CUBE = (Piece(Sphere(0.1)),), (Piece(Box((0.2, 0.2, 0.2))),)
FLOOR = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
WALL = fixed("wall", (Piece(Box((0.1, 4.0, 4.0))),), "wood", (1.0, 0.0, 0.0))
NOWHERE = (0.0, 0.0, 0.0)


def cube(name: str, place: tuple[float, float, float], mass: float = 1.0):
    return simulated(name, CUBE, "wood", solid(CUBE, mass), place)


def free(engine: AvatarsimEngine) -> bool:
    return not overlapping_pairs(engine._running().world)


def load(scene: Scene, start: str = "nearest") -> tuple[AvatarsimEngine, FrameRecord]:
    engine = AvatarsimEngine()
    return engine, engine.load(scene, Settings(start=start), DT)


@pytest.mark.parametrize("depth", [1e-6, 0.03, 0.11])
def test_a_hand_in_a_floor_begins_on_it(depth: float) -> None:
    avatar = hand(BALL)
    scene = Scene("s", (FLOOR,), (avatar,), start=at(rest((avatar,)), (0.3, -0.2, 0.1 - depth)))
    engine, record = load(scene)
    assert free(engine)
    assert record.shown.positions[1] == pytest.approx((0.3, -0.2, 0.1), abs=3e-4)
    (moved,) = record.moved
    assert moved.name == "hand" and moved.distance == pytest.approx(depth, abs=3e-4)
    assert [pair[:2] for pair in moved.overlaps] == [("floor", "hand")]
    assert moved.overlaps[0][2] == pytest.approx(depth, abs=1e-9)
    assert record.statuses == {"moved_at_start": 1}


def test_a_free_start_is_left_alone_to_the_bit() -> None:
    scene = catalog.get("hand_over_table").build()
    near, exact = load(scene)[1], load(scene, start="exact")[1]
    assert near.state_hash() == exact.state_hash() and near.moved == ()


def test_two_avatars_in_each_other_both_move() -> None:
    one, other = hand(BALL), replace(hand(BALL), name="other", links=(replace(hand(BALL).links[0], name="other"),))
    engine, record = load(Scene("s", (), (one, other)))
    assert free(engine)
    assert [moved.distance for moved in record.moved] == pytest.approx([0.1, 0.1], abs=1e-3)


def test_an_arm_in_a_wall_bends_and_stays() -> None:
    avatar = mixed_avatar()
    start = at(rest((avatar,)), (0.0, 0.0, 0.2))
    low = replace(start, positions=start.positions - (0.0, 0.0, 0.25))
    engine, record = load(Scene("s", (FLOOR,), (avatar,), start=low))
    assert free(engine) and record.moved
    before = record.shown.positions
    for _ in range(5):
        record = engine.advance(low, DT)
        assert free(engine)
    # held off, it has nowhere to go
    assert np.abs(record.shown.positions - before).max() < 0.02


def test_loose_bodies_make_way_for_avatars_and_for_heavier_ones() -> None:
    avatar = hand(BALL)
    scene = Scene("s", (cube("box", (0.12, 0.0, 0.0)),), (avatar,), gravity=NOWHERE)
    _, record = load(scene)
    assert [moved.name for moved in record.moved] == ["box"]
    bodies = (cube("light", (0.0, 0.0, 0.0), 1.0), cube("heavy", (0.1, 0.0, 0.0), 9.0))
    _, record = load(Scene("s", bodies, gravity=NOWHERE))
    far = {moved.name: moved.distance for moved in record.moved}
    assert far["light"] + far["heavy"] == pytest.approx(0.1, abs=5e-4)
    assert far["light"] > 5.0 * far["heavy"] > 0.0


def test_a_wedged_body_moves_the_avatar() -> None:
    slot = (
        fixed("left", (Piece(Box((0.2, 1.0, 1.0))),), "wood", (-0.201, 0.0, 0.0)),
        fixed("right", (Piece(Box((0.2, 1.0, 1.0))),), "wood", (0.201, 0.0, 0.0)),
        fixed("back", (Piece(Box((0.6, 0.2, 1.0))),), "wood", (0.0, 0.201, 0.0)),
        fixed("top", (Piece(Box((0.6, 1.0, 0.2))),), "wood", (0.0, 0.0, 0.201)),
        fixed("low", (Piece(Box((0.6, 1.0, 0.2))),), "wood", (0.0, 0.0, -0.201)),
    )
    avatar = hand((Piece(Sphere(0.05)),))
    box = cube("box", (0.0, 0.0, 0.0))
    start = at(rest((avatar,)), (0.0, -0.13, 0.0))
    engine, record = load(Scene("s", (*slot, box), (avatar,), start=start, gravity=NOWHERE))
    assert free(engine)
    far = {moved.name: moved.distance for moved in record.moved}
    assert far["hand"] == pytest.approx(0.02, abs=2e-3) and far.get("box", 0.0) < 2e-3


def test_what_rests_beside_an_overlap_stays_to_the_bit() -> None:
    resting = cube("resting", (2.0, 0.0, 0.1))
    pair = (cube("one", (0.0, 0.0, 0.5)), cube("other", (0.05, 0.0, 0.5)))
    _, record = load(Scene("s", (FLOOR, resting, *pair)))
    assert {moved.name for moved in record.moved} == {"one", "other"}
    assert tuple(record.shown.positions[1]) == (2.0, 0.0, 0.1)


def test_a_row_of_bodies_that_is_tight_is_moved_as_a_whole() -> None:
    row = tuple(cube(f"b{k}", (0.2 * k, 0.0, 0.0)) for k in range(5))
    walls = tuple(fixed(f"w{k}", (Piece(Box((0.2, 2.0, 2.0))),), "wood", (x, 0.0, 0.0)) for k, x in enumerate((-0.21, 1.06)))
    late = cube("late", (0.3, 0.0, 0.0))
    engine, record = load(Scene("s", (*walls, *row, late), gravity=NOWHERE))
    assert free(engine) and max(moved.distance for moved in record.moved) < 0.35


def test_an_attached_body_goes_with_its_link() -> None:
    avatar = hand(BALL)
    held = cube("held", (0.0, 0.0, 0.25))
    start = at(rest((avatar,)), (0.0, 0.0, 0.05))
    engine, record = load(Scene("s", (FLOOR, held), (avatar,), start=start, attached=(("held", "hand"),)))
    assert free(engine) and engine.attached() == {"held": "hand"}
    assert record.shown.positions[1] - record.shown.positions[2] == pytest.approx((0.0, 0.0, 0.2), abs=1e-3)


def test_a_slide_and_coupled_hinges_keep_their_limits_and_ratio() -> None:
    bone = (Piece(Capsule(0.04, 0.2), (0.15, 0.0, 0.0), turned(Y, np.pi / 2)),)
    arm = Link("arm", "root", Hinges((Hinge(Y, -1.5, 1.5),)), bone, solid(BALL, 1.0))
    tip = replace(arm, name="tip", parent="arm", anchor=(0.35, 0.0, 0.0))
    out = Slide((1.0, 0.0, 0.0), 0.0, 0.1)
    drawer = Link("drawer", "tip", out, (Piece(Sphere(0.03)),), solid(BALL, 1.0), anchor=(0.35, 0.0, 0.0))
    root = Link("root", None, Rigid(), (Piece(Sphere(0.05)),), solid(BALL, 1.0), anchor=(0.35, 0.0, 0.06))
    avatar = Avatar("a", (root, arm, tip, drawer), couplings=(Coupling(1, 0, 0.5, 0.0),))
    start = replace(rest((avatar,)), angles=np.array([0.2, 0.1, 0.05]))
    engine, record = load(Scene("s", (FLOOR,), (avatar,), start=start))
    assert free(engine) and record.moved
    assert record.angles[1] == pytest.approx(0.5 * record.angles[0], abs=1e-9) and 0.0 <= record.angles[2] <= 0.1


def test_a_start_that_nothing_frees_is_refused() -> None:
    stuck = Avatar("a", (Link("root", None, Rigid(), BALL, solid(BALL, 1.0)),))
    engine = loaded(catalog.get("hand_over_table").build())
    before = engine.snapshot()
    with pytest.raises(StartOverlaps) as error:
        engine.load(Scene("s", (FLOOR,), (stuck,)), Settings(), DT)
    assert [pair[:2] for pair in error.value.pairs] == [("floor", "a")]
    assert engine.snapshot() == before


def test_put_and_reset_begin_at_the_nearest_free_posture() -> None:
    avatar = hand(BALL)
    high, low = (at(rest((avatar,)), (0.0, 0.0, z)) for z in (0.5, 0.02))
    engine, _ = load(Scene("s", (FLOOR,), (avatar,), start=high))
    for begin in (engine.put, engine.reset):
        record = begin(low)
        assert record.shown.positions[1, 2] == pytest.approx(0.1, abs=3e-4) and free(engine)
        assert [moved.name for moved in record.moved] == ["hand"]
    # the user was put into the floor, and its motion from there is followed
    record = engine.advance(at(high, (0.01, 0.0, 0.02)), DT)
    assert record.shown.positions[1] == pytest.approx((0.01, 0.0, 0.1), abs=1e-3)


def test_an_avatar_held_off_its_user_strikes_nothing_loose() -> None:
    avatar = hand(BALL)
    block = fixed("block", (Piece(Box((1.0, 1.0, 1.0))),), "wood", (0.0, 0.0, 0.0))
    ball = simulated("ball", BALL, "wood", solid(BALL, 0.2), (0.0, 0.0, 0.85))
    start = at(rest((avatar,)), (0.0, 0.0, 0.45))
    engine, record = load(Scene("s", (block, ball), (avatar,), start=start, gravity=NOWHERE))
    assert [moved.name for moved in record.moved] == ["hand"]
    for _ in range(10):
        record = engine.advance(start, DT)
    assert np.abs(record.shown.velocities[1]).max() < 1e-6


@pytest.mark.parametrize("name", ["start_inside", "deep_overlap", "coincident_start"])
def test_the_same_scene_begins_and_goes_on_the_same(name: str) -> None:
    scenario = catalog.get(name)
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    engines = [load(scene) for _ in range(2)]
    assert engines[0][1].state_hash() == engines[1][1].state_hash()
    for k in range(3):
        alone = engines[0][0].advance(motion(k), scenario.dt)
        (many,) = advance_many([engines[1][0]], [motion(k)], scenario.dt)
        assert alone.state_hash() == many.state_hash() and free(engines[0][0])
