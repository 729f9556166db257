"""Bodies attached to links: they keep their place, weigh on the drive, stop the link at obstacles, fly on when released."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.attaching import is_antipodal
from avatarsim.engine import FrameRecord, Settings
from avatarsim.errors import InvalidInput, UnknownName, UnsupportedScene
from avatarsim.many_worlds import advance_many
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from avatarsim.tolerances import JUDGED
from scenarios import catalog
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from tests.coupling.scenes import FLOOR, LAW, cube, deepest, fist
from tests.rigid.upper_world import G
from tests.worlds.loaded import DT, loaded

K = 1000.0
SLIPS = 1e-9
"""Farthest that an attached body goes from its place [m]."""


def led(place: tuple[float, float, float], angle: float = 0.0) -> TrackerSample:
    """Return a hand at a place, turned about y."""
    return TrackerSample(0.0, np.array([place]), rotation.from_axis_angle((0.0, 1.0, 0.0), angle)[None], np.zeros(0))


def begun(*bodies: Body, place: tuple[float, float, float] = (0.0, 0.0, 0.1502)) -> tuple[AvatarsimEngine, Scene]:
    """Return an engine with a floor, these bodies and a hand."""
    scene = Scene("attached", (FLOOR, *bodies), (fist(),), materials=LAW, start=led(place))
    engine = loaded(scene)
    return engine, scene


def place_on(record: FrameRecord, body: int, link: int) -> np.ndarray:
    """Return the position of a body in the frame of a link [m]."""
    shown = record.shown
    return rotation.rotate(rotation.conjugate(shown.orientations[link]), shown.positions[body] - shown.positions[link])


def waved(k: int) -> TrackerSample:
    """Return a hand that rises, is led to and fro and turned, and holds still after two seconds."""
    t = min(k * DT, 2.0)
    return led((0.3 * np.sin(2.0 * t), 0.1 * np.sin(4.0 * t), 0.1502 + 0.3 * min(1.0, t)), 0.6 * np.sin(3.0 * t))


@pytest.mark.parametrize("mass", [0.05, 0.3, 2.0, 10.0])
def test_it_keeps_its_place_and_weighs_on_the_drive(mass: float) -> None:
    engine, scene = begun(cube(mass))
    engine.attach("cube", "fist")
    assert engine.attached() == {"cube": "fist"}
    records = [engine.advance(waved(k), DT) for k in range(300)]
    first = place_on(records[0], 1, 2)
    assert max(np.linalg.norm(place_on(one, 1, 2) - first) for one in records) < SLIPS
    user = waved(299).positions[0]
    assert user[2] - records[-1].shown.positions[2, 2] == pytest.approx(mass * G / K, rel=2e-2)
    assert deepest(scene, records) <= JUDGED


def test_released_it_flies_on_with_its_velocity() -> None:
    engine, _ = begun(cube(0.2))
    engine.attach("cube", "fist")
    for k in range(60):
        record = engine.advance(led((1.5 * k * DT, 0.0, 0.1502 + 0.5 * min(1.0, k * DT))), DT)
    before, speed = record.shown.positions[1], record.shown.velocities[1]
    assert speed[0] == pytest.approx(1.5, rel=1e-3)
    engine.detach("cube")
    assert not engine.attached()
    for k in range(60, 72):
        record = engine.advance(led((1.5 * k * DT, 0.0, 0.9)), DT)
    t = 12 * DT
    assert record.shown.positions[1] == pytest.approx(before + speed * t - [0.0, 0.0, 0.5 * G * t * t], abs=2e-3)


def test_what_it_runs_into_stops_the_hand() -> None:
    table = fixed("table", (Piece(Box((0.6, 0.6, 0.1))),), "m", (0.8, 0.0, 0.25))
    engine, scene = begun(table, cube(0.3))
    engine.attach("cube", "fist")
    records = [engine.advance(led((0.8 * min(1.0, k * DT), 0.0, 0.2 + 0.3 * min(1.0, 4.0 * k * DT))), DT) for k in range(60)]
    records += [engine.advance(led((0.8, 0.0, 0.5 - 0.3 * min(1.0, k * DT))), DT) for k in range(60)]
    # the cube lies on the table and the hand on the cube, though its user is 0.3 m below
    assert records[-1].shown.positions[3, 2] == pytest.approx(0.45, abs=1e-3)
    assert deepest(scene, records) <= JUDGED
    assert max(np.linalg.norm(place_on(one, 2, 3) - place_on(records[0], 2, 3)) for one in records) < 10.0 * SLIPS


def test_it_pushes_loose_bodies_as_a_part_of_the_hand_would() -> None:
    engine, scene = begun(cube(0.3), cube(0.5, (0.4, 0.0, 0.05), "other"))
    engine.attach("cube", "fist")
    records = [engine.advance(led((min(0.8, 0.5 * k * DT), 0.0, 0.152)), DT) for k in range(150)]
    assert records[-1].shown.positions[2, 0] > 0.85
    assert deepest(scene, records) <= JUDGED


def walked(
    mass: float, aside: tuple[float, float], way: Callable[[float], float], frames: int, *walls: Body
) -> tuple[Scene, list[FrameRecord], np.ndarray]:
    """Return a person's walk along x with a cube at the right wrist: scene, frames, places of the cube on the wrist."""
    person = replace(humanoid(), name="person")
    person = replace(person, links=tuple(replace(link, material="m") for link in person.links))
    start, wrist = standing(person), "person/right_wrist"
    alone = Scene("person", (FLOOR, *walls, cube(mass, (-1.5, 0.0, 0.0501))), (person,), materials=LAW, start=start)
    link = alone.names.index(wrist)
    place = loaded(alone).reset().shown.positions[link]
    place = place + [aside[0], aside[1] * np.sign(place[1]), 0.0]
    scene = replace(alone, bodies=(FLOOR, *walls, cube(mass, tuple(place.tolist()))))
    engine, records = loaded(scene), []
    engine.attach("cube", wrist)
    for k in range(frames):
        there = start.positions.copy()
        there[0, 0] += way(k * DT)
        records.append(engine.advance(replace(start, time=k * DT, positions=there), DT))
    return scene, records, np.array([place_on(one, 1 + len(walls), link) for one in records])


def test_a_person_carries_a_box_on_one_hand() -> None:
    scene, records, places = walked(1.0, (0.0, 0.12), lambda time: 0.5 * min(1.0, 0.5 * time), 120)
    assert np.linalg.norm(places - places[0], axis=1).max() < 1e-4
    assert records[-1].shown.positions[1, 0] - records[0].shown.positions[1, 0] > 0.4
    assert deepest(scene, records) <= JUDGED


def test_a_lift_holds_what_is_attached_to_it() -> None:
    lift = moving("lift", (Piece(Box((0.5, 0.5, 0.05))),), "m", position=(0.0, 0.0, 0.3), largest_force=1000.0)
    scene = Scene("lift", (FLOOR, cube(1.0, (0.0, 0.0, 0.15))), (lift,), materials=LAW)
    engine = loaded(scene)
    engine.attach("cube", "lift")
    for k in range(120):
        record = engine.advance(rest(()), DT, moving={"lift": ((0.0, 0.0, 0.3 + 0.3 * min(1.0, k * DT)), (1.0, 0.0, 0.0, 0.0))})
    assert record.shown.positions[1, 2] == pytest.approx(0.45, abs=1e-4)


def test_snapshots_changes_and_many_worlds_keep_it() -> None:
    engine, scene = begun(cube(0.3), cube(0.3, (1.0, 0.0, 0.05), "other"))
    engine.attach("cube", "fist")
    for k in range(40):
        engine.advance(waved(k), DT)
    kept = engine.snapshot()
    one = [engine.advance(waved(k), DT).state_hash() for k in range(40, 80)]
    other, _ = begun(cube(0.3), cube(0.3, (1.0, 0.0, 0.05), "other"))
    other.restore(kept)
    assert other.attached() == {"cube": "fist"}
    assert [advance_many([other], [waved(k)], DT)[0].state_hash() for k in range(40, 80)] == one
    # without the other cube, and with another hand before this one: places in the scene change
    engine.change(replace(
        scene, bodies=(cube(0.3), FLOOR), avatars=(fist("new"), fist()),
        start=replace(rest((fist("new"), fist())), positions=np.array([(2.0, 2.0, 1.0), (0.0, 0.0, 0.1502)])),
    ))
    assert engine.attached() == {"cube": "fist"}
    first = None
    for k in range(80, 140):
        user = waved(k)
        record = engine.advance(replace(
            user, positions=np.array([(2.0, 2.0, 1.0), user.positions[0]]),
            rotations=np.array([(1.0, 0.0, 0.0, 0.0), user.rotations[0]]),
        ), DT)
        first = place_on(record, 0, 3) if first is None else first
    assert np.linalg.norm(place_on(record, 0, 3) - first) < SLIPS


def test_a_grip_is_found_where_friction_holds() -> None:
    left, right = np.array([-0.1, 0.0, 0.0]), np.array([0.1, 0.0, 0.0])
    into = np.array([1.0, 0.0, 0.0])
    assert is_antipodal((left, into, 0.3), (right, -into, 0.3))
    assert not is_antipodal((left, into, 0.3), (right, into, 0.3))
    assert not is_antipodal((left, -into, 0.3), (right, into, 0.3))
    # a line that leaves the friction cone
    higher = right + [0.0, 0.0, 0.1]
    assert is_antipodal((left, into, 0.51), (higher, -into, 0.51)) and not is_antipodal((left, into, 0.49), (higher, -into, 0.49))
    assert not is_antipodal((left, into, 1.0), (left, -into, 1.0))


@pytest.mark.parametrize(("body", "link"), [
    ("floor", "fist"), ("cube", "floor"), ("nothing", "fist"), ("cube", "cube"),
])
def test_what_cannot_be_attached_is_refused(body: str, link: str) -> None:
    engine, _ = begun(cube(0.3))
    before = engine.snapshot()
    with pytest.raises(UnknownName):
        engine.attach(body, link)
    assert engine.snapshot() == before


def test_nothing_is_attached_twice_or_detached_untouched() -> None:
    engine, scene = begun(cube(0.3))
    engine.attach("cube", "fist")
    with pytest.raises(InvalidInput):
        engine.attach("cube", "fist")
    engine.detach("cube")
    with pytest.raises(UnknownName):
        engine.detach("cube")
    with pytest.raises(UnknownName):
        engine.grip("nobody")
    assert engine.grip("fist") == ()
    paper = AvatarsimEngine()
    paper.load(scene, Settings("paper"), DT)
    with pytest.raises(InvalidInput):
        paper.attach("cube", "fist")


def test_three_fingers_grip_a_mug_once_they_close_on_it() -> None:
    scenario = catalog.get("mug_in_fingers")
    scene = scenario.build()
    engine, motion, found = AvatarsimEngine(), scenario.motion(scene, 0), []
    engine.load(scene, Settings(), scenario.dt)
    for k in range(40):
        engine.advance(motion(k), scenario.dt)
        found.append(engine.grip("hand"))
    assert found[0] == () and found[-1] == ("mug",)
    assert engine.attached()["mug"].startswith("hand/")


@pytest.mark.parametrize("count", [2, 4, 20])
def test_a_row_of_cubes_keeps_its_places(count: int) -> None:
    """Twenty weigh 6 kg, twelve times the fist."""
    row = [cube(0.3, (0.11 * k, 0.0, 0.0501), f"cube {k}") for k in range(count)]
    engine, scene = begun(*row)
    for body in row:
        engine.attach(body.name, "fist")
    records = [engine.advance(waved(k), DT) for k in range(180)]
    hand = len(scene.names) - 1
    assert deepest(scene, records) <= JUDGED
    assert len(engine.attached()) == count
    for k in range(count):
        first = place_on(records[0], 1 + k, hand)
        assert max(np.linalg.norm(place_on(one, 1 + k, hand) - first) for one in records) < SLIPS


@pytest.mark.parametrize("mass", [0.1, 1.0, 10.0])
def test_a_person_with_a_box_walks_into_a_wall(mass: float) -> None:
    wall = fixed("wall", (Piece(Box((0.1, 4.0, 4.0))),), "m", (1.2, 0.0, 0.0))
    scene, records, places = walked(mass, (0.13, 0.0), lambda time: min(1.5, time), 150, wall)
    assert np.linalg.norm(places - places[0], axis=1).max() < 2e-3
    assert deepest(scene, records) <= JUDGED


AROUND_Z = Hinges((Hinge((0.0, 0.0, 1.0), -2.0, 2.0),))


def test_a_body_on_an_upright_hinge_on_the_floor_stays_finite() -> None:
    """Its contacts with the floor cannot move at all."""
    piece = (Piece(Box((0.1, 0.1, 0.1)), (0.06, 0.0, 0.0)),)
    arm = Avatar("arm", (Link("p", None, AROUND_Z, piece, solid(piece, 1.0), "m", (0.0, 0.0, 0.3)),), size_range=(0.0, 100.0))
    scene = Scene("upright", (FLOOR, cube(1.0, (0.1, 0.0, 0.05002), "thing")), (arm,), materials=LAW)
    engine = loaded(scene)
    engine.attach("thing", "arm")
    records = [engine.advance(replace(rest((arm,)), angles=np.array([np.sin(3.0 * k * DT)])), DT) for k in range(90)]
    assert max(float(np.abs(one.shown.velocities).max()) for one in records) < 2.0
    assert deepest(scene, records) <= JUDGED
    assert records[-1].angles[0] == pytest.approx(np.sin(3.0 * 89 * DT), abs=0.1)


def test_bodies_on_two_links_that_touch_stay_finite() -> None:
    trunk, arm = (Piece(Box((0.2, 0.2, 0.2))),), (Piece(Box((0.3, 0.06, 0.06)), (0.25, 0.0, 0.0)),)
    avatar = Avatar("two", (
        Link("trunk", None, Free(), trunk, solid(trunk, 5.0), "m"),
        Link("arm", "trunk", AROUND_Z, arm, solid(arm, 1.0), "m", (0.1, 0.0, 0.0)),
    ), ignore=(("trunk", "arm"),), size_range=(0.0, 100.0))
    ball = (Piece(Sphere(0.03)),)
    bodies = [simulated(name, ball, "m", solid(ball, 0.2), place) for name, place in (
        ("one", (0.15, 0.0, 1.0 + 0.13)), ("other", (0.15, 0.0, 1.0 + 0.1902)))]
    start = TrackerSample(0.0, np.array([(0.0, 0.0, 1.0), (0.0, 0.0, 0.0)]), np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), np.zeros(1))
    scene = Scene("two links", (FLOOR, *bodies), (avatar,), materials=LAW, start=start)
    engine = loaded(scene)
    engine.attach("one", "two/trunk")
    engine.attach("other", "two/arm")
    records = [engine.advance(replace(start, angles=np.array([0.8 * np.sin(4.0 * k * DT)])), DT) for k in range(120)]
    assert all(np.isfinite(one.shown.positions).all() for one in records)
    assert max(float(np.abs(one.shown.velocities).max()) for one in records) < 5.0


@pytest.mark.parametrize("narrow", ["coupling", "dynamics", "overlap_removal"])
def test_refuses_changes_that_cannot_hold_what_is_attached(narrow: str) -> None:
    engine, scene = begun(cube(1.0), cube(1.0, (1.0, 0.0, 0.05), "other"))
    engine.attach("cube", "fist")
    engine.attach("other", "fist")
    for _ in range(5):
        before = engine.advance(led((0.0, 0.0, 0.3)), DT)
    with pytest.raises(UnsupportedScene):
        engine.change(replace(scene, narrow=(narrow,)))
    assert engine.attached() == {"cube": "fist", "other": "fist"}
    assert engine.advance(led((0.0, 0.0, 0.3)), DT).shown.time > before.shown.time


@pytest.mark.parametrize("narrow", ["coupling", "dynamics"])
def test_scenes_that_attach_nothing_say_so(narrow: str) -> None:
    _, scene = begun(cube(1.0))
    engine = loaded(replace(scene, narrow=(narrow,)))
    with pytest.raises(UnsupportedScene):
        engine.attach("cube", "fist")
    assert not engine.attached()
    with pytest.raises(UnsupportedScene):
        engine.load(replace(scene, narrow=(narrow,), attached=(("cube", "fist"),)), Settings(), DT)


def test_a_body_with_another_centre_of_mass_keeps_its_place() -> None:
    engine, scene = begun(cube(1.0))
    engine.attach("cube", "fist")
    for _ in range(30):
        before = engine.advance(led((0.0, 0.0, 0.3)), DT).shown
    heavy_top = solid((Piece(Box((0.1, 0.1, 0.1)), (0.0, 0.0, 0.03)),), 1.0)
    engine.change(replace(scene, bodies=(FLOOR, replace(cube(1.0), mass=heavy_top))))
    after = engine.advance(led((0.0, 0.0, 0.3)), DT).shown
    assert after.positions[1] - after.positions[2] == pytest.approx(before.positions[1] - before.positions[2], abs=1e-9)


def test_a_change_attaches_what_it_newly_says() -> None:
    engine, scene = begun(cube(1.0))
    engine.advance(led((0.0, 0.0, 0.1502)), DT)
    engine.change(replace(scene, attached=(("cube", "fist"),)))
    assert engine.attached() == {"cube": "fist"}
    engine.detach("cube")
    engine.change(replace(scene, attached=(("cube", "fist"),), name="again"))
    assert not engine.attached()
