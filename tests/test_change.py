"""Bodies come and go between frames: bodies of both scenes go on as if nothing had happened, all else begins as it is given."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from avatarsim.errors import AvatarsimError, InvalidInput, InvalidScene, StartOverlaps
from avatarsim.model.geometry import place
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, Mass, fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.settings import PostureSettings
from avatarsim.simulator import AvatarsimEngine
from scenarios.catalog import get
from tests.stability.hostile import DT
from tests.worlds.little_worlds import X, Z, at, hand, mixed_avatar, random_sample, sliding_avatar
from tests.worlds.loaded import loaded

BALL, CRATE = (Piece(Sphere(0.1)),), (Piece(Box((0.2, 0.3, 0.1))),)
TABLE = fixed("table", (Piece(Box((1.0, 1.0, 0.1))),), "wood", (0.0, 0.0, -0.05))
HAND = hand()
START = at(rest((HAND,)), (0.0, 0.0, 0.5))


def loose(name: str, place: tuple[float, float, float], shape: tuple[Piece, ...] = BALL) -> Body:
    """Return a body that flies through the air, turning."""
    speed, spin = (0.1, 0.0, 0.0), (1.0, 2.0, 3.0)
    return simulated(name, shape, "wood", solid(shape, 1.0), place, velocity=speed, angular_velocity=spin)


def rows(engine: AvatarsimEngine, *names: str) -> list[list[bytes]]:
    """Return the bits of the shown state of some bodies."""
    shown, order = engine._record({}, {}, ()).shown, engine._running().world.scene.names
    arrays = shown.positions, shown.orientations, shown.velocities, shown.angular_velocities
    return [[array[order.index(name)].tobytes() for array in arrays] for name in names]


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_what_flies_goes_on_flying_while_bodies_come_and_go(preset: str) -> None:
    before = Scene("a", (TABLE, loose("crate", (0.0, 0.0, 3.0), CRATE), loose("ball", (2.0, 0.0, 3.0))), (HAND,), start=START)
    after = Scene("b", (loose("new", (5.0, 0.0, 3.0)), loose("ball", (9.0, 9.0, 9.0)), TABLE), (HAND,), start=START)
    engine, alone = loaded(before, preset), loaded(before, preset)
    for _ in range(20):
        record = engine.advance(START, DT)
        alone.advance(START, DT)
    shown = engine.change(after).shown
    assert shown.time == record.shown.time and shown.positions[0] == pytest.approx((5.0, 0.0, 3.0))
    assert rows(engine, "ball", "hand") == rows(alone, "ball", "hand")
    for k in range(10):
        engine.advance(START, DT)
        alone.advance(START, DT)
        assert rows(engine, "ball", "hand") == rows(alone, "ball", "hand"), k
    assert engine.reset().shown.positions[1] == pytest.approx((9.0, 9.0, 9.0)), "where the new scene has it"


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_postures_are_carried_to_the_bit(preset: str) -> None:
    avatar = sliding_avatar() if preset == "default" else mixed_avatar()
    far = at(rest((avatar,)), (0.0, 0.0, 3.0))
    scene = Scene("a", (TABLE,), (HAND, avatar), start=_both(START, far))
    engine = loaded(scene, preset)
    for seed in range(3):
        drawn = random_sample((avatar,), seed)
        asked = _both(START, replace(drawn, positions=far.positions + 0.1 * drawn.positions))
        for _ in range(5):
            record = engine.advance(asked, DT)
    other = Scene("b", (TABLE, loose("ball", (5.0, 0.0, 0.5))), (avatar,), start=far)
    shown = engine.change(other)
    assert shown.shown.positions[2:].tobytes() == record.shown.positions[2:].tobytes()
    assert shown.shown.orientations[2:].tobytes() == record.shown.orientations[2:].tobytes()
    assert shown.angles.tobytes() == record.angles.tobytes()
    engine.advance(replace(asked, positions=asked.positions[1:], rotations=asked.rotations[1:]), DT)


def _both(one: TrackerSample, other: TrackerSample) -> TrackerSample:
    return TrackerSample(0.0, *(
        np.concatenate([getattr(one, name), getattr(other, name)]) for name in ("positions", "rotations", "angles")
    ))


def test_a_hand_set_free_by_a_change_keeps_its_pace() -> None:
    """Not at once: its user was at that place before, so that no frame's own motion is as long as the way there."""
    engine = loaded(Scene("a", (TABLE,), (HAND,), start=START))
    for k in range(60):
        record = engine.advance(at(START, (0.0, 0.0, 0.5 - 0.02 * k)), DT)
    held = record.shown.positions[-1, 2]
    assert held > 0.0
    engine.change(Scene("b", (), (HAND,), start=START))
    heights = [engine.advance(at(START, (0.0, 0.0, -0.68)), DT).shown.positions[-1, 2] for _ in range(60)]
    pace = PostureSettings().catch_up_move * DT
    assert (-np.diff([held, *heights]) <= 1.1 * pace).all() and heights[-1] == pytest.approx(-0.68, abs=1e-3)


def test_a_moving_hand_strikes_as_hard_as_without_a_change() -> None:
    scene = Scene("a", (loose("ball", (0.4, 0.0, 0.5)),), (HAND,), start=START, gravity=(0.0, 0.0, 0.0))
    engine, alone = loaded(scene), loaded(scene)
    for k in range(1, 40):
        asked = at(START, (0.02 * k, 0.0, 0.5))
        engine.advance(asked, DT)
        alone.advance(asked, DT)
        if k % 3 == 0:
            engine.change(replace(scene, bodies=(TABLE, *scene.bodies) if k % 2 else scene.bodies))
    struck = [one._running().world.velocities.linear[one._running().world.scene.names.index("ball")] for one in (engine, alone)]
    assert struck[1][0] > 0.5 and struck[0] == pytest.approx(struck[1], rel=1e-6)


def test_a_sleeping_stack_falls_when_what_held_it_is_gone() -> None:
    crate = simulated("crate", CRATE, "wood", solid(CRATE, 1.0), (0.0, 0.0, 0.0501))
    engine = loaded(Scene("a", (TABLE, crate)))
    nothing = rest(())
    for _ in range(60):
        record = engine.advance(nothing, DT)
    stood = record.shown.positions[1, 2]
    engine.change(Scene("b", (crate,)))
    for _ in range(30):
        record = engine.advance(nothing, DT)
    assert record.shown.positions[0, 2] == pytest.approx(stood - 0.5 * 9.81 * 0.25, abs=1e-6)


def test_a_stack_at_rest_that_dips_goes_on_through_a_change() -> None:
    scene = get("heavy_on_light").build()
    engine, names = loaded(scene), [body.name for body in scene.bodies]
    for _ in range(120):
        engine.advance(scene.first_sample, DT)
    # resting bodies may be deeper in each other than a start may, by fractions of the judged depth
    world = engine._running().world
    while not overlapping_pairs(world):
        world.poses.position[-1, 2] -= 1e-7
        place(world.geometry, world.poses, len(scene.names) - 1)
    before = rows(engine, *names)
    more = replace(loose("ball", (20.0, 0.0, 3.0)), material="box")
    engine.change(replace(scene, bodies=(*scene.bodies, more)))
    assert rows(engine, *names) == before
    top = max(scene.bodies, key=lambda body: body.position[2])
    with pytest.raises(StartOverlaps, match="ball"):
        engine.change(replace(scene, bodies=(*scene.bodies, replace(more, name="other ball", position=top.position))))


def test_a_body_with_another_centre_of_mass_keeps_its_frame() -> None:
    one = simulated("b", BALL, "wood", Mass(1.0), (0.0, 0.0, 2.0), angular_velocity=(0.0, 0.0, 5.0))
    other = replace(one, mass=Mass(1.0, (0.02, 0.0, 0.0)))
    engine = loaded(Scene("a", (one,), gravity=(0.0, 0.0, 0.0)))
    before = engine.advance(rest(()), DT).shown
    after = engine.change(Scene("b", (other,), gravity=(0.0, 0.0, 0.0))).shown
    assert after.positions == pytest.approx(before.positions) and after.orientations == pytest.approx(before.orientations)
    turn = 5.0 * DT
    assert after.velocities[0] == pytest.approx(5.0 * 0.02 * np.array([-np.sin(turn), np.cos(turn), 0.0]))


def hinged(low: float, high: float) -> Avatar:
    """Return a limb on a root, with limits."""
    limb = Link("limb", "root", Hinges((Hinge(X, low, high),)), BALL, solid(BALL, 1.0), anchor=(0.0, 0.0, 0.5))
    return Avatar("a", (Link("root", None, Free(), BALL, solid(BALL, 1.0)), limb))


def overlapping() -> Scene:
    return Scene("b", (replace(TABLE, position=(0.0, 0.0, 0.5)),), (HAND,), start=START)


@pytest.mark.parametrize(("scene", "error"), [(overlapping(), StartOverlaps), ("room", InvalidInput)])
def test_a_change_that_fails_leaves_the_engine_as_it_is(scene: Any, error: type[AvatarsimError]) -> None:
    engine = loaded(Scene("a", (TABLE,), (HAND,), start=START))
    engine.advance(START, DT)
    before = engine.snapshot()
    with pytest.raises(error):
        engine.change(scene)
    assert engine.snapshot() == before and engine.advance(START, DT).shown.time == pytest.approx(2.0 * DT)


def test_new_limits_hold_from_the_change_on() -> None:
    wide, narrow = hinged(-1.0, 1.0), hinged(-1.0, 0.2)
    engine = loaded(Scene("a", (), (wide,)))
    for _ in range(60):
        engine.advance(replace(rest((wide,)), angles=np.array([2.0])), DT)
    # at its limit to the bit, which is within it
    assert engine.change(Scene("b", (), (wide,))).angles[0] == 1.0
    with pytest.raises(InvalidScene, match="start angle of a hinge of limb"):
        engine.change(Scene("b", (), (narrow,)))


def test_an_avatar_of_another_build_begins_at_the_start() -> None:
    one, other = hinged(-1.0, 1.0), hinged(-1.0, 1.0)
    other = replace(other, links=(other.links[0], replace(other.links[1], joint=Hinges((Hinge(Z),)))))
    engine = loaded(Scene("a", (), (one,)))
    engine.advance(replace(rest((one,)), angles=np.array([0.1])), DT)
    assert engine.change(Scene("b", (), (other,), start=at(rest((other,)), (0.0, 0.0, 7.0)))).shown.positions[0, 2] == 7.0


