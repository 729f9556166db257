"""Commands of a driven world: their changes, their refusals, and that a refusal changes nothing."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput
from avatarsim.live.messages import Command, Order, Switch
from avatarsim.live.orders import World, posture_of, scene_at
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.spatial import rotation
from scenarios.catalog import get
from scenarios.engines import opened
from tests.live.small import plan, pushed


def driven(frames: int = 60) -> World:
    """Return the small world after some frames."""
    world = World(plan())
    for frame in range(1, frames + 1):
        world.advance(pushed(frame))
    return world


def test_reset_begins_the_scene_again() -> None:
    world = driven()
    first = World(plan()).shown.state_hash()
    assert world.shown.state_hash() != first
    # without a snapshot, BACK restarts the scene too
    for order in (Order.RESET, Order.BACK):
        assert world.apply(Command(order)) == "" and world.shown.state_hash() == first
        world.advance(pushed(1))


def test_back_comes_to_what_was_kept_and_goes_on_alike() -> None:
    world = driven()
    assert world.apply(Command(Order.KEEP)) == ""
    kept = world.shown.state_hash()
    once = [world.advance(pushed(frame)).state_hash() for frame in range(61, 91)]
    assert world.apply(Command(Order.BACK)) == "" and world.shown.state_hash() == kept
    assert [world.advance(pushed(frame)).state_hash() for frame in range(61, 91)] == once


@pytest.mark.parametrize("switch", [
    Switch(("friction",)), Switch(("dynamics", "coupling")), Switch((), "paper"), Switch((), "default", {"stand_off": 1e-3}),
    Switch(("limits", "restitution"), "paper"),
])
def test_a_switch_goes_on_from_what_is_shown(switch: Switch) -> None:
    world = driven(20)
    before = world.shown.shown
    assert world.apply(Command(Order.SWITCH, switch)) == ""
    after = world.shown.shown
    np.testing.assert_allclose(after.positions, before.positions, atol=1e-12)
    if "dynamics" not in switch.off:
        # for loose bodies; links have the speed of their targets, which begin again
        np.testing.assert_allclose(after.velocities[1], before.velocities[1], atol=1e-12)
    assert world.settings.preset == switch.preset and set(switch.off) <= set(world.scene.narrow)
    world.advance(pushed(21))
    refused = world.apply(Command(Order.SWITCH, Switch()))
    if "limits" in switch.off:
        # the finger is beyond its limits: it has to come back first
        assert "start angle of a hinge of finger" in refused and set(switch.off) <= set(world.scene.narrow)
    else:
        assert refused == "" and world.scene.narrow == world.plan.scene.narrow


@pytest.mark.parametrize(("value", "says"), [
    (Switch(("gravity",)), "effect is 'gravity'"), (Switch(("kinematics",)), "narrows"), (Switch((), "other"), "preset"),
    (Switch((), "default", {"nothing": 1}), "option of avatarsim"), ("friction", "a Switch"), (None, "a Switch"),
])
def test_what_is_refused_changes_nothing(value: object, says: str) -> None:
    world = driven(30)
    before, engine = world.shown.state_hash(), world.engine
    assert says in world.apply(Command(Order.SWITCH, value))
    assert world.shown.state_hash() == before and world.engine is engine
    twin = driven(30)
    assert [world.advance(pushed(k)).state_hash() for k in range(31, 41)] == [
        twin.advance(pushed(k)).state_hash() for k in range(31, 41)
    ]


@pytest.mark.parametrize("rate", [0.0, -60.0, float("nan"), 1e9])
def test_a_rate_that_is_none_is_refused(rate: float) -> None:
    with pytest.raises(InvalidInput, match="frames a second of a loop"):
        World(replace(plan(), rate=rate))


def test_a_scene_begins_where_it_was_shown() -> None:
    world = driven(70)
    again = World(replace(plan(), scene=scene_at(world.scene, world.shown)))
    for name in ("positions", "orientations"):
        np.testing.assert_allclose(getattr(again.shown.shown, name), getattr(world.shown.shown, name), atol=1e-12)
    np.testing.assert_allclose(again.shown.angles, world.shown.angles)


@given(seed=st.integers(0, 2**32 - 1))
def test_the_posture_of_poses_is_the_inverse_of_kinematics(seed: int) -> None:
    scene = get("mocap_walk").build()
    random = np.random.default_rng(seed)
    first = scene.first_sample
    turns = rotation.normalised(random.normal(size=first.rotations.shape))
    sample = TrackerSample(0.0, random.normal(size=first.positions.shape), turns, random.uniform(-1.0, 1.0, first.angles.shape))
    poses = link_poses(scene.avatars, sample)
    found = link_poses(scene.avatars, posture_of(scene, *poses, sample.angles))
    np.testing.assert_allclose(found[0], poses[0], atol=1e-12)
    np.testing.assert_allclose(np.abs((found[1] * poses[1]).sum(axis=1)), 1.0, atol=1e-12)


def test_a_switch_leaves_the_preset_of_another_engine_alone() -> None:
    engine = opened("mujoco")
    rival = replace(plan(), settings=Settings(preset="tuned"), name="mujoco/tuned")
    world = World(rival, type(engine))
    before = world.shown.shown.positions
    assert world.apply(Command(Order.SWITCH, Switch(("friction",), "paper"))) == ""
    assert world.settings.preset == "tuned" and "friction" in world.scene.narrow
    np.testing.assert_allclose(world.shown.shown.positions, before, atol=1e-6)
    for order in (Order.KEEP, Order.BACK, Order.TAKE):
        assert "an engine that takes snapshots" in world.apply(Command(order))
    assert world.apply(Command(Order.RESET)) == ""
