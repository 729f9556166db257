"""Attached bodies at the edges: contacts that no joint can move, scenes that cannot hold them, other centres of mass."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import UnsupportedScene
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.tolerances import JUDGED
from tests.coupling.scenes import FLOOR, LAW, cube, deepest
from tests.coupling.test_attached import begun, led
from tests.worlds.loaded import DT, loaded

AROUND_Z = Hinges((Hinge((0.0, 0.0, 1.0), -2.0, 2.0),))


def test_a_body_on_the_floor_that_turns_about_an_upright_hinge_stays_finite() -> None:
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
def test_a_change_that_could_not_hold_what_is_attached_is_refused_and_changes_nothing(narrow: str) -> None:
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
