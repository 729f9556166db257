"""Hands and grippers with hinges under load: what they hold comes along and does not slip, within the limits of joints."""

from dataclasses import dataclass

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.model.skeleton import forward
from avatarsim.model.world import build
from avatarsim.rigid.driven import aim
from avatarsim.rigid.linkages import bind_one, weigh_linkages
from avatarsim.rigid.state import make_memory
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation

DT = 1.0 / 60.0
HIGH = 0.09
"""Height of what is held [m]."""
LIFT, TILT = 0.15, np.radians(60.0)
"""How far a hand lifts, and turns [m], [rad]."""


def eased(time: float, begin: float, end: float) -> float:
    """Share gone of a smooth way from rest to rest."""
    s = float(np.clip((time - begin) / (end - begin), 0.0, 1.0))
    return s * s * s * (10.0 + s * (6.0 * s - 15.0))


@dataclass(frozen=True)
class Grip:
    """A palm above a thing, the angles of its hinges when open, and how far they close."""

    avatar: Avatar
    thing: Body
    friction: float
    palm: float
    """Height of the palm's origin [m] at first."""
    closing: np.ndarray

    def sample(self, time: float) -> TrackerSample:
        """Close, lift, tilt, turn back, set down, open."""
        closed = eased(time, 0.1, 0.7) - eased(time, 4.6, 5.0)
        height = self.palm + LIFT * (eased(time, 0.9, 1.7) - eased(time, 3.7, 4.5))
        turn = rotation.from_axis_angle((0.0, 1.0, 0.0), TILT * (eased(time, 1.9, 2.6) - eased(time, 2.8, 3.5)))
        links = len(self.avatar.links)
        turns = np.vstack([turn, np.tile(rotation.IDENTITY, (links - 1, 1))])
        return TrackerSample(time, np.vstack([(0.0, 0.0, height), np.zeros((links - 1, 3))]), turns, closed * self.closing)


def prism(radius: float, sides: int = 24) -> Piece:
    """A standing prism."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Piece(ConvexHull(np.vstack([np.hstack([ring, np.full((sides, 1), z)]) for z in (-0.5 * HIGH, 0.5 * HIGH)])))


def mug_grip(seed: int) -> Grip:
    """Three to five fingers of one hinge around a mug: radius, mass and friction are drawn."""
    random = np.random.default_rng(seed)
    fingers, radius, mass = int(random.integers(3, 6)), random.uniform(0.028, 0.04), random.uniform(0.1, 0.5)
    reach, bone = radius + 0.027, (Piece(Capsule(0.009, 0.08), (0.0, 0.0, -0.05)),)
    palm = (Piece(Box((1.4 * reach, 1.4 * reach, 0.02))),)
    links = [Link("palm", None, Free(), palm, solid(palm, 0.5), "m")]
    for k in range(fingers):
        angle = 2.0 * np.pi * k / fingers
        x, y = float(np.cos(angle)), float(np.sin(angle))
        hinge = Hinges((Hinge((y, -x, 0.0), -0.6, 0.6),))
        links.append(Link(f"finger {k}", "palm", hinge, bone, solid(bone, 0.08), "m", (reach * x, reach * y, -0.012)))
    shape = (prism(radius),)
    mug = simulated("thing", shape, "m", solid(shape, mass), (0.0, 0.0, 0.5 * HIGH + 2e-7))
    return Grip(Avatar("hand", tuple(links)), mug, random.uniform(0.6, 0.9), 0.135, np.full(fingers, -0.42))


def gripper(seed: int) -> Grip:
    """A robot's gripper: two fingers of two hinges and flat pads, whose tips come together first, around a box."""
    random = np.random.default_rng(seed)
    edge, mass = random.uniform(0.04, 0.06), random.uniform(0.1, 0.4)
    wrist, upper, pad = (Piece(Box((0.12, 0.04, 0.02))),), (Piece(Box((0.012, 0.03, 0.04)), (0.0, 0.0, -0.024)),), (
        Piece(Box((0.008, 0.03, 0.045)), (0.0, 0.0, -0.027)),
    )
    links = [Link("wrist", None, Free(), wrist, solid(wrist, 0.8), "m")]
    for side, name in ((1.0, "right"), (-1.0, "left")):
        bend = Hinges((Hinge((0.0, 1.0, 0.0), -1.0, 1.0),))
        anchor = (side * (0.5 * edge + 0.02), 0.0, -0.012)
        links.append(Link(f"{name} finger", "wrist", bend, upper, solid(upper, 0.1), "m", anchor))
        links.append(Link(f"{name} pad", f"{name} finger", bend, pad, solid(pad, 0.05), "m", (0.0, 0.0, -0.046)))
    shape = (Piece(Box((edge, edge, HIGH))),)
    box = simulated("thing", shape, "m", solid(shape, mass), (0.0, 0.0, 0.5 * HIGH + 2e-7))
    return Grip(Avatar("gripper", tuple(links)), box, random.uniform(0.6, 0.9), 0.155, np.array([0.45, -0.35, -0.45, 0.35]))


def held_through(grip: Grip) -> None:
    """Run a grip; the thing must rise, turn with the hand without slipping, stand again and be let go."""
    floor = fixed("floor", (Piece(Box((2.0, 2.0, 0.2))),), "m", (0.0, 0.0, -0.1))
    table = PairTable({("m", "m"): ContactLaw(0.0, grip.friction)})
    scene = Scene("grip", (floor, grip.thing), (grip.avatar,), materials=table, start=grip.sample(0.0))
    engine, limits = AvatarsimEngine(), [hinge for link in grip.avatar.links[1:] for hinge in link.joint.hinges]
    engine.load(scene, Settings(), DT)
    world, places, user = engine._frames.world, [], 0.0
    for k in range(330):
        sample = grip.sample((k + 1) * DT)
        record = engine.advance(sample, DT)
        angles = record.angles
        assert all(hinge.lower - 1e-9 <= a <= hinge.upper + 1e-9 for hinge, a in zip(limits, angles, strict=True))
        assert engine.contacts(0.0) == () or min(contact.gap for contact in engine.contacts(0.0)) >= -1e-6
        if k % 30 == 0:
            twin, degrees = build(scene), len(world.posture.angle)
            forward(twin.geometry, twin.skeleton, world.posture, np.zeros(degrees), twin.poses, np.zeros((degrees, 3)))
            assert world.poses.position[2:] == pytest.approx(twin.poses.position[2:], abs=1e-12)
        turn = rotation.to_matrix(record.shown.orientations[2])
        places.append(turn.T @ (record.shown.positions[1] - record.shown.positions[2]))
        user = max(user, record.shown.positions[1, 2])
    assert user > 0.5 * HIGH + 0.9 * LIFT
    # from lifted to before it is set down
    assert np.ptp(np.array(places)[105:220], axis=0) == pytest.approx(0.0, abs=1e-3)
    assert record.shown.positions[1, 2] == pytest.approx(0.5 * HIGH, abs=1e-3)
    assert np.linalg.norm(record.shown.velocities[1]) < 1e-3


@pytest.mark.parametrize("seed", range(20))
def test_a_hand_lifts_a_mug_tilts_it_and_sets_it_down(seed: int) -> None:
    held_through(mug_grip(seed))


@pytest.mark.parametrize("seed", range(5))
def test_a_gripper_of_hinges_does_the_same(seed: int) -> None:
    held_through(gripper(seed))


def test_joints_leave_the_nearest_velocities_that_they_allow() -> None:
    """Weighted least squares with the Jacobian by differences; a hinge at its limit does not go beyond."""
    grip, random = gripper(1), np.random.default_rng(2)
    table = PairTable({("m", "m"): ContactLaw(0.0, grip.friction)})
    world = build(Scene("grip", (grip.thing,), (grip.avatar,), materials=table, start=grip.sample(0.3)))
    geometry, skel, poses = world.geometry, world.skeleton, world.poses
    memory, drive = make_memory(geometry, world.dynamics, poses), world.drive
    drive.coupled[1:], drive.linked[1:], drive.stiffness[:], drive.damping[:] = 1, 1, 1000.0, 40.0
    drive.linkage.joints.angle[:] = world.posture.angle
    for b in range(1, len(drive.coupled)):
        aim(drive, poses, world.velocities, memory, b, 0.0, DT, DT)
    members = np.arange(len(drive.coupled))
    weigh_linkages(world.dynamics, poses, memory, members)
    degrees, links = len(world.posture.angle), len(skel.kind)
    jacobian, step = np.zeros((6 * links, degrees)), 1e-6
    for j in range(degrees):
        moved = [build(world.scene).poses for _ in range(2)]
        for sign, out in zip((1.0, -1.0), moved, strict=True):
            forward(geometry, skel, world.posture, sign * step * np.eye(degrees)[j], out, np.zeros((degrees, 3)))
        jacobian[0::6, j], jacobian[1::6, j], jacobian[2::6, j] = (
            (moved[0].position - moved[1].position)[1:] / (2.0 * step)
        ).T
        turned = np.einsum("bij,bkj->bik", moved[0].rotation - moved[1].rotation, poses.rotation)[1:] / (2.0 * step)
        jacobian[3::6, j], jacobian[4::6, j], jacobian[5::6, j] = turned[:, 2, 1], turned[:, 0, 2], turned[:, 1, 0]
    memory.linear_end[1:], memory.angular_end[1:] = random.normal(size=(2, links, 3))
    wanted = np.hstack([memory.linear_end[1:], memory.angular_end[1:]]).ravel()
    weights = np.hstack([
        np.tile(1.0 / memory.hold.inverse_mass[1:, None], (1, 3)), np.tile(memory.inertia[1:, :1, 0], (1, 3)),
    ]).ravel()
    root = np.sqrt(weights)
    rates = np.linalg.lstsq(root[:, None] * jacobian, root * wanted, rcond=None)[0]
    bind_one(drive.linkage, poses, memory, 0, links, 1e-6)
    assert drive.linkage.rate == pytest.approx(rates, abs=1e-8)
    assert np.hstack([memory.linear_end[1:], memory.angular_end[1:]]).ravel() == pytest.approx(jacobian @ rates, abs=1e-7)
    # the same for a frame so long that limits bind
    memory.linear_end[1:], memory.angular_end[1:] = wanted.reshape(links, 6)[:, :3], wanted.reshape(links, 6)[:, 3:]
    bind_one(drive.linkage, poses, memory, 0, links, 1.0)
    hinges = slice(6, None)
    reached = world.posture.angle[hinges] + drive.linkage.rate[hinges]
    assert (reached >= skel.limits[hinges, 0] - 1e-12).all()
    assert (reached <= skel.limits[hinges, 1] + 1e-12).all()
    held = drive.linkage.held == 1
    assert held.any()
    left = (jacobian.T * weights) @ (wanted - jacobian @ drive.linkage.rate)
    assert left[~held] == pytest.approx(0.0, abs=1e-8)
    outward = np.where(drive.linkage.rate > 0.0, 1.0, -1.0)
    assert (left * outward)[held].min() >= 0.0
