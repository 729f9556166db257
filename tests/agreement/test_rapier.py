"""Rapier: closed forms reached by its tuned preset, joints and limits of the scene, and traps of its settings."""

from collections.abc import Mapping
from math import sqrt
from typing import Any

import numpy as np
import pytest
import rapier3d as rapier

from avatarsim.engine import Settings
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.spatial import rotation
from reference.collision_groups import collision_groups
from reference.in_rapier.engine import RapierEngine
from tests.agreement.runs import FRAME, MM, depths, limit_excess, loaded, of_catalog, played
from tests.agreement.scenes import every_joint, posture

LIMB = (Piece(Capsule(0.03, 0.2), (0.15, 0.0, 0.0), (sqrt(0.5), 0.0, sqrt(0.5), 0.0)),)


@pytest.mark.parametrize("rate", [240, 960])
def test_a_ball_bounces_by_its_restitution(rate: int) -> None:
    """A beta release was known for wrong restitution: each version is checked."""
    scene, records = of_catalog(RapierEngine(), "bounce_ladder", Settings("tuned", {"dt": 1.0 / rate}, record_inside=True), 120)
    states = [state for record in records for state in record.inside]
    for k, body in enumerate(scene.bodies):
        speeds = np.array([state.velocities[k, 2] for state in states])
        rises = np.flatnonzero((speeds[1:] > 0.0) & (speeds[:-1] < 0.0))
        wanted = scene.materials.pairs.get((body.material, scene.bodies[-1].material))
        if len(rises) and wanted is not None and wanted.restitution > 0.0:
            assert speeds[rises[0] + 1] / -speeds[rises[0]] == pytest.approx(wanted.restitution, abs=2e-3)


def test_recycled_contacts_are_found_late() -> None:
    """The default keeps contact points until shapes have moved 5 cm; disabling this is the tuned preset's main change."""
    deepest = {}
    for recycling in (True, False):
        options = {"contact_recycling": recycling, "dt": 1.0 / 240.0}
        scene, records = of_catalog(RapierEngine(), "ball_drop", Settings("default", options), 120)
        deepest[recycling] = depths(scene, records).max()
    assert deepest[True] > 1.0 * MM and deepest[False] < 0.2 * MM


def arm(joint: Ball | Hinges) -> Avatar:
    """Return a root that the user holds in place, and a limb."""
    root = (Piece(Box((0.1, 0.1, 0.1))),)
    return Avatar("arm", (Link("root", None, Free(), root, solid(root, 5.0)),
                          Link("limb", "root", joint, LIMB, solid(LIMB, 0.3), anchor=(0.1, 0.0, 0.0))))


@pytest.mark.parametrize("diagonal", [False, True])
@pytest.mark.parametrize(("swing", "most"), [("ropes", 1.0), ("axes", 16.0)])
def test_a_cone_of_ropes_is_round_and_one_of_axes_cornered(diagonal: bool, swing: str, most: float) -> None:
    """A limb in a cone of 40 degrees has a target of 80, with targets not clamped to the limits."""
    limits = SwingTwist((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), np.radians(40.0), (-0.3, 0.3))
    scene = Scene("cone", avatars=(arm(Ball(limits)),), gravity=(0.0, 0.0, 0.0))
    axis = np.array((0.0, 1.0, 1.0 if diagonal else 0.0))
    still = rest(scene.avatars)
    samples = []
    for frame in range(1, 121):
        turns = still.rotations.copy()
        turns[1] = rotation.from_axis_angle(axis / np.linalg.norm(axis), np.radians(80.0) * min(1.0, frame / 60.0))
        samples.append(TrackerSample(frame * FRAME, still.positions, turns, still.angles))
    options: Mapping[str, object] = {"swing_limits": swing, "clamp_targets": False}
    excess = limit_excess(scene, played(RapierEngine(), scene, samples, Settings("tuned", options)))
    assert excess[-1] < most
    if swing == "axes" and diagonal:
        assert excess[-1] > 5.0


@pytest.mark.parametrize("asked", [-2.0, 0.3, 2.0])
def test_hinges_that_share_a_centre_follow_and_stop(asked: float) -> None:
    joint = Hinges((Hinge((0.0, 1.0, 0.0), -0.5, 0.5), Hinge((0.0, 0.0, 1.0), -0.5, 0.5)))
    scene = Scene("hinges", avatars=(arm(joint),), gravity=(0.0, 0.0, 0.0))
    still = rest(scene.avatars)
    samples = [TrackerSample(frame * FRAME, still.positions, still.rotations, np.full(2, asked * min(1.0, frame / 60.0)))
               for frame in range(1, 121)]
    shown = played(RapierEngine(), scene, samples, Settings("tuned"))[-1]
    assert shown.angles == pytest.approx(np.clip(np.full(2, asked), -0.5, 0.5), abs=0.02)


def test_a_hinge_without_stops_counts_turns() -> None:
    scene = Scene("wheel", avatars=(arm(Hinges((Hinge((1.0, 0.0, 0.0)),))),), gravity=(0.0, 0.0, 0.0))
    still = rest(scene.avatars)
    samples = [TrackerSample(frame * FRAME, still.positions, still.rotations, np.array([0.2 * frame])) for frame in range(1, 101)]
    assert played(RapierEngine(), scene, samples, Settings("tuned"))[-1].angles == pytest.approx([20.0], abs=0.05)


def test_posture_within_limits_is_kept() -> None:
    avatar = every_joint()
    links = tuple(link for link in avatar.links if link.name in ("root", "one", "three"))
    avatar = Avatar("hinged", links)
    sample = posture(avatar, 0)
    scene = Scene("still", avatars=(avatar,), start=sample)
    shown = played(RapierEngine(), scene, [sample] * 60, Settings("tuned"))[-1]
    assert np.abs(shown.shown.positions - link_poses(scene.avatars, sample)[0]).max() < 1e-4


def test_settings_reach_the_solver() -> None:
    """Assigning a softness in place changes a copy: whole objects are assigned."""
    scene = Scene("hand", avatars=(arm(Ball()),))
    parameters = loaded(RapierEngine(), scene, Settings("tuned"))._world.physics.integration_parameters
    assert parameters.contact_softness.natural_frequency == pytest.approx(480.0)
    assert parameters.static_contact_softness.damping_ratio == pytest.approx(2.0)
    assert not parameters.contact_recycling and parameters.friction_in_bias_pass


def test_a_step_takes_one_core() -> None:
    engine = loaded(RapierEngine(), Scene("hand", avatars=(arm(Ball()),)), Settings("default"))
    threads, reason = dict[str, Any](engine.settings_as_run())["threads"]
    assert threads == 1 and reason


def test_the_world_can_be_restored_from_its_own_words() -> None:
    scene, engine = Scene("hand", avatars=(arm(Ball()),)), RapierEngine()
    engine.load(scene, Settings("tuned"), FRAME)
    kind, text = engine.native()
    again = rapier.PhysicsWorld.restore_json(text)
    assert kind == "json" and len(list(again.rigid_bodies.handles())) == 4


def meets(groups: list[tuple[int, int]], a: int, b: int) -> bool:
    """Return True if Rapier lets two bodies of these groups collide."""
    return bool(groups[a][0] & groups[b][1] and groups[b][0] & groups[a][1])


@pytest.mark.parametrize("seed", range(20))
def test_groups_say_which_bodies_meet(seed: int) -> None:
    draw = np.random.default_rng(seed)
    n = int(draw.integers(2, 40))
    kinds = draw.integers(0, min(n, 6), n)
    wanted = np.triu(draw.random((6, 6)) < 0.5)
    table = (wanted | wanted.T)[np.ix_(kinds, kinds)]
    groups = collision_groups(table)
    assert groups is not None
    for a in range(n):
        for b in range(a + 1, n):
            assert meets(groups, a, b) == table[a, b]


def test_pairs_that_masks_cannot_express_pass_by_joints(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two links that are allowed to overlap do so, and stay."""
    monkeypatch.setattr("reference.in_rapier.world.collision_groups", lambda meets: None)
    ball = (Piece(Sphere(0.1)),)
    links = (Link("root", None, Free(), ball, solid(ball, 1.0)),
             *(Link(name, "root", Ball(), ball, solid(ball, 1.0), anchor=(0.3, 0.0, 0.0)) for name in ("a", "b")))
    scene = Scene("passing", avatars=(Avatar("three", links, ignore=(("a", "b"),)),), gravity=(0.0, 0.0, 0.0))
    still = rest(scene.avatars)
    shown = played(RapierEngine(), scene, [still] * 30, Settings("tuned"))[-1]
    assert np.abs(shown.shown.positions[1] - shown.shown.positions[2]).max() < 1e-4
