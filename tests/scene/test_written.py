"""Scenes as JSON and back: all of the catalogue's to the bit, and a file that is none gives a message that names the place."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.engine import Settings
from avatarsim.errors import InvalidFile, InvalidInput, StartOverlaps
from avatarsim.scene.avatar import Avatar, Drive, Link, rigid_avatar
from avatarsim.scene.body import Mass, fixed, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, ReachCone
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.written import TAG, TYPES, scene_from, written
from avatarsim.simulator import AvatarsimEngine
from scenarios.catalog import get, scenarios
from scenarios.scenario import Scenario
from tests.live.small import arm, scene


def again(one: Scene) -> Scene:
    """Return the scene, through JSON."""
    return scene_from(json.loads(json.dumps(written(one), allow_nan=False)), "x")


def shown(scenario: Scenario, one: Scene, frames: int) -> list[str]:
    """Return hashes of the states that a scene shows; or why it is not loaded."""
    motion = scenario.motion(scenario.build(), 0)
    with AvatarsimEngine() as engine:
        try:
            first = engine.load(one, Settings(), scenario.dt).state_hash()
        except StartOverlaps as error:
            return [str(error)]
        return [first, *(engine.advance(motion(frame), scenario.dt).state_hash() for frame in range(frames))]


@pytest.mark.parametrize(("name", "frames"), [*((name, 4) for name in sorted(scenarios())), ("hand_grasp", 30)])
def test_every_scene_comes_back_and_shows_the_same_states(name: str, frames: int) -> None:
    scenario = get(name)
    one = scenario.build()
    assert written(again(one)) == written(one)
    assert shown(scenario, again(one), frames) == shown(scenario, one, frames)


@given(st.integers(3, 8), st.integers(0, 2**32 - 1))
def test_reach_cones_come_back_to_the_bit(corners: int, seed: int) -> None:
    """Made unit vectors once more, their corners would move in the last place."""
    rng = np.random.default_rng(seed)
    turn = 2.0 * np.pi * (np.arange(corners) + rng.uniform(0.0, 0.4, corners)) / corners
    vertices = np.stack([np.cos(turn), np.sin(turn), rng.uniform(0.9, 1.1, corners)], axis=-1)
    joint = Ball(None, ReachCone(vertices, (0.0, 0.0, 1.0)))
    links = replace(arm().links[0], mass=Mass(1.0)), replace(arm().links[1], joint=joint)
    back = again(Scene("cone", (), (replace(arm(), links=links),))).avatars[0].links[1].joint
    assert isinstance(back, Ball) and back.cone is not None and joint.cone is not None
    assert back.cone.vertices.tobytes() == joint.cone.vertices.tobytes() and not back.cone.vertices.flags.writeable


def at(data: Any, path: tuple[str | int, ...]) -> Any:
    """Return the value at a place."""
    for part in path:
        data = data[part]
    return data


BACKWARDS = {TAG: "Hinge", "axis": [0, 1, 0], "lower": 1.0, "upper": -1.0}
LINK = ("avatars", 0, "links", 1)


@pytest.mark.parametrize(("path", "name", "value", "says"), [
    ((), "name", 3, "scene.name of x"),
    ((), "gravity", [0.0, 0.0], r"scene.gravity of x.*a list of 3"),
    ((), "gravity", [0.0, "0", 0.0], r"scene.gravity\[1\] of x.*a number"),
    ((), "bodies", {"a": 1}, "scene.bodies of x.*a list"),
    ((), "more", 1, "the entries name, bodies"),
    ((), TAG, "Body", '"is": "Scene"'),
    (("bodies", 0), "role", "DRIVER", "one of FIXED, SIMULATED, DRIVEN"),
    (("bodies", 0), "role", ["FIXED"], "one of FIXED"),
    (("bodies", 0, "pieces", 0), "shape", {TAG: "Scene"}, "one of Sphere"),
    (("bodies", 0, "pieces", 0), "shape", None, "one of Sphere"),
    (("bodies", 1, "mass"), "inertia", [[1.0], [1.0, 2.0]], "numbers .* in rows of one length"),
    (("bodies", 1, "mass"), "inertia", "nan", "a list"),
    (("bodies", 1, "mass"), "mass", True, "a number"),
    (("bodies", 1, "mass"), "mass", 10**400, r"mass.mass of x.*1e\+100"),
    (("bodies", 1, "mass"), "inertia", [[1e160, 0, 0], [0, 1e160, 0], [0, 0, 1e160]], r"mass.inertia of x.*1e\+100"),
    (("bodies", 0), "orientation", [1e160, 1e160, 0, 0], r"orientation\[0\] of x"),
    (("bodies", 0, "pieces", 0), "shape", {TAG: "ConvexHull", "vertices": [[1e308, 0, 0]] * 4}, "shape.vertices of x"),
    (LINK, "joint", {TAG: "Hinges", "hinges": [dict(BACKWARDS)]}, "limit"),
    (LINK, "parent", "nothing", "parent of link finger"),
    (("materials",), "pairs", [[["a", "b", "c"], None]], r"pairs\[0\]\[0\] of x"),
])
def test_what_is_no_scene_is_named_by_its_place(path: tuple[str | int, ...], name: str, value: object, says: str) -> None:
    data = json.loads(json.dumps(written(scene())))
    at(data, path)[name] = value
    with pytest.raises(InvalidInput, match=says):
        scene_from(data, "x")


@pytest.mark.parametrize("missing", ["name", "bodies", TAG])
def test_what_is_missing_is_refused(missing: str) -> None:
    data = written(scene())
    del data[missing]
    with pytest.raises(InvalidFile):
        scene_from(data, "x")


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5) | st.sampled_from(sorted(TYPES)),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5) | st.just(TAG), inner, max_size=4),
    max_leaves=8,
)


@given(data=st.data())
def test_anything_at_any_place_is_a_scene_or_refused(data: st.DataObject) -> None:
    whole = json.loads(json.dumps(written(scene())))
    place: Any = whole
    held: Any = None
    key: Any = None
    for _ in range(data.draw(st.integers(1, 7))):
        if isinstance(place, dict) and place:
            held, key = place, data.draw(st.sampled_from(sorted(place)))
        elif isinstance(place, list) and place:
            held, key = place, data.draw(st.integers(0, len(place) - 1))
        else:
            break
        place = held[key]
    held[key] = data.draw(JSON)
    try:
        assert isinstance(scene_from(whole, "x"), Scene)
    except InvalidInput:
        pass


def test_moving_bodies_and_drives_come_back() -> None:
    ball = (Piece(Sphere(0.05)),)
    hand = replace(rigid_avatar("hand", ball, solid(ball, 0.5), "wood"), drive=Drive(stiffness=0.0))
    belt = moving("belt", ball, "wood", position=(1.0, 0.0, 0.0), surface_velocity=(0.5, 0.0, 0.0))
    made = Scene("moves", (), (hand, belt))
    assert written(again(made)) == written(made)
    assert again(made).avatars[0].drive == hand.drive and again(made).avatars[1].drive == belt.drive


def test_pairs_that_overlap_at_home_come_back() -> None:
    hinge = Link("b", "a", Hinges((Hinge((0.0, 0.0, 1.0)),)), (Piece(Sphere(0.1)),), Mass(1.0))
    avatar = Avatar("pair", (Link("a", None, Free(), (Piece(Sphere(0.1)),), Mass(1.0)), hinge, replace(hinge, name="c")),
                    at_rest=(("b", "c", 0.25),))
    one = Scene("s", (fixed("wall", (Piece(Sphere(0.1)),), "wood"),), (avatar,), at_rest=(("pair/b", "wall", 0.125),))
    back = again(one)
    assert (back.at_rest, back.avatars[0].at_rest) == (one.at_rest, avatar.at_rest)
    assert back.resting == ((0, 2, 0.125), (2, 3, 0.25))
    data = written(one)
    del data["at_rest"], data["avatars"][0]["at_rest"]
    assert scene_from(data, "an older file").resting == ()
