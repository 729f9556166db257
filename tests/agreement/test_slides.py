"""Slides in other engines: links start at the tracker's poses, and move along their axes within limits."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from avatarsim.engine import Engine, Settings
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Coupling, Hinge, Hinges, Rigid, Slide
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import link_poses, rest
from reference.in_mujoco.engine import MujocoEngine
from reference.targets import Targets
from tests.agreement.rivals import ENGINES, PybulletEngine, digits, needs_pybullet
from tests.worlds.little_worlds import random_sample, sliding_avatar

BOX = (Piece(Box((0.1, 0.1, 0.1))),)
LEAN = (0.8, 0.0, 0.6, 0.0)


def gantry() -> Avatar:
    """Return a bridge on an inclined rail, a carriage on the bridge, and an arm that turns below it."""
    mass = solid(BOX, 1.0)
    return Avatar("gantry", (
        Link("rail", None, Rigid(), BOX, mass),
        Link("bridge", "rail", Slide((1.0, 0.0, 0.0), -1.0, 1.0), BOX, mass, anchor=(0.0, 0.3, 0.0), orientation=LEAN),
        Link("carriage", "bridge", Slide((0.0, 1.0, 0.0), -0.5, 0.2), BOX, mass, anchor=(0.0, 0.3, 0.1)),
        Link("arm", "carriage", Hinges((Hinge((0.0, 0.0, 1.0), -1.0, 1.0),)), BOX, mass, anchor=(0.3, 0.3, 0.2)),
    ))


@ENGINES
@pytest.mark.parametrize("preset", ["default", "tuned"])
def test_links_go_where_slides_have_them(engine: Engine, preset: str) -> None:
    avatar, asked = gantry(), np.array([0.4, -0.3, 0.5])
    start = replace(rest((avatar,)), angles=np.array([0.1, 0.05, -0.2]))
    scene = Scene("gantry", avatars=(avatar,), start=start, gravity=(0.0, 0.0, 0.0))
    first = engine.load(scene, Settings(preset), 1.0 / 60.0)
    assert first.shown.positions == pytest.approx(link_poses((avatar,), start)[0], abs=1e-6)
    assert first.angles == pytest.approx(start.angles, abs=digits(engine, 1e-9, 1e-6))
    for frame in range(1, 121):
        angles = start.angles + min(1.0, frame / 60.0) * (asked - start.angles)
        record = engine.advance(replace(start, time=frame / 60.0, angles=angles), 1.0 / 60.0)
    assert record.angles == pytest.approx(asked, abs=0.02)
    assert record.shown.positions == pytest.approx(link_poses((avatar,), replace(start, angles=asked))[0], abs=0.02)


@needs_pybullet
def test_mujoco_has_a_coupling_and_pybullet_names_none() -> None:
    avatar = replace(gantry(), couplings=(Coupling(2, 0, 0.5, 0.1),))
    scene, engine = Scene("gantry", avatars=(avatar,), start=rest((avatar,))), MujocoEngine()
    engine.load(scene, Settings("tuned"), 1.0 / 60.0)
    model = engine._world.model
    (gear,) = np.flatnonzero(model.eq_type == mujoco.mjtEq.mjEQ_JOINT)
    assert model.eq_data[gear, :5].tolist() == [0.1, 0.5, 0.0, 0.0, 0.0]
    assert [model.joint(int(model.eq_obj1id[gear])).name, model.joint(int(model.eq_obj2id[gear])).name] == ["h2", "h0"]
    assert "couplings" not in engine.unsupported(scene) and "couplings" in PybulletEngine().unsupported(scene)


@pytest.mark.parametrize("seed", range(3))
def test_targets_have_the_plain_kinematics(seed: int) -> None:
    avatars = (sliding_avatar(),)
    scene, sample = Scene("targets", avatars=avatars, start=random_sample(avatars, seed)), random_sample(avatars, seed + 9)
    goals = Targets(scene, clamp=False).between(scene.first_sample, sample, np.array([0.5, 1.0]))
    assert goals.positions[1] == pytest.approx(link_poses(avatars, sample)[0], abs=1e-12)
