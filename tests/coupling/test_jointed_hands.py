"""Hands and grippers with hinges under load: held bodies come along and do not slip, within the limits of joints."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.engine import Settings
from avatarsim.model.joint_limits import cone_excess, has_cone, inside_cone, room_of_ball, room_of_twist
from avatarsim.model.skeleton import BALL, forward
from avatarsim.model.world import World, build
from avatarsim.rigid.contacts import add_contact, weigh
from avatarsim.rigid.driven import aim
from avatarsim.rigid.link_rows import weigh_links
from avatarsim.rigid.linkages import move_linkages, show_linkages, weigh_linkages
from avatarsim.rigid.solver import apply_to_links, lay_out
from avatarsim.rigid.state import Memory, make_memory
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges, axes_of
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from avatarsim.spatial.tangent import columns
from avatarsim.spatial.vec3 import neg
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.motion.keyframes import posed

DT = 1.0 / 60.0
HIGH = 0.09
"""Height of the held body [m]."""
LIFT, TILT = 0.15, np.radians(60.0)
"""Lift [m] and turn [rad] of a hand."""


def eased(time: float, begin: float, end: float) -> float:
    """Return the share gone of a smooth way from rest to rest."""
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
        """Return the user's sample: close, lift, tilt, turn back, set down, open."""
        closed = eased(time, 0.1, 0.7) - eased(time, 4.6, 5.0)
        height = self.palm + LIFT * (eased(time, 0.9, 1.7) - eased(time, 3.7, 4.5))
        turn = rotation.from_axis_angle((0.0, 1.0, 0.0), TILT * (eased(time, 1.9, 2.6) - eased(time, 2.8, 3.5)))
        links = len(self.avatar.links)
        turns = np.vstack([turn, np.tile(rotation.IDENTITY, (links - 1, 1))])
        return TrackerSample(time, np.vstack([(0.0, 0.0, height), np.zeros((links - 1, 3))]), turns, closed * self.closing)


def prism(radius: float, sides: int = 24) -> Piece:
    """Return a standing prism."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return Piece(ConvexHull(np.vstack([np.hstack([ring, np.full((sides, 1), z)]) for z in (-0.5 * HIGH, 0.5 * HIGH)])))


def mug_grip(seed: int) -> Grip:
    """Return three to five fingers of one hinge around a mug: radius, mass and friction are drawn."""
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
    """Return a robot's gripper: two fingers of two hinges and flat pads, whose tips come together first, around a box."""
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
    engine, limits = AvatarsimEngine(), [hinge for link in grip.avatar.links[1:] for hinge in axes_of(link.joint)]
    engine.load(scene, Settings(), DT)
    world, places, user = engine._running().world, [], 0.0
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


@pytest.mark.parametrize("seed", range(8))
def test_a_hand_lifts_a_mug_tilts_it_and_sets_it_down(seed: int) -> None:
    held_through(mug_grip(seed))


@pytest.mark.parametrize("seed", range(3))
def test_a_gripper_of_hinges_does_the_same(seed: int) -> None:
    held_through(gripper(seed))


def linkage_of(avatar: Avatar, start: TrackerSample, h: float) -> tuple[World, Memory, np.ndarray, np.ndarray, np.ndarray]:
    """Return an avatar with random velocities of its links, weighed for h seconds: world, memory, Jacobian of its links (6 nl,
    nd) by differences, weights and velocities (6 nl) of them."""
    table = PairTable(dict.fromkeys([("m", "m"), ("human", "human")], ContactLaw(0.0, 0.5)))
    world = build(Scene("linkage", (), (avatar,), materials=table, start=start))
    skel, poses, drive = world.skeleton, world.poses, world.drive
    drive.may_couple[:], drive.coupled[:], drive.linked[:], drive.stiffness[:], drive.damping[:] = 1, 1, 1, 1000.0, 40.0
    memory = make_memory(world.geometry, world.dynamics, poses)
    for mine, theirs in zip(drive.linkage.joints, world.posture, strict=True):
        mine[:] = theirs
    links, degrees, step = len(skel.kind), len(world.posture.angle), 1e-6
    for b in range(links):
        aim(drive, poses, world.velocities, memory, b, 0.0, DT, DT)
    jacobian = np.zeros((links, 6, degrees))
    for j in range(degrees):
        moved = [build(world.scene).poses for _ in range(2)]
        for sign, out in zip((1.0, -1.0), moved, strict=True):
            forward(world.geometry, skel, world.posture, sign * step * np.eye(degrees)[j], out, np.zeros((degrees, 3)))
        jacobian[:, :3, j] = (moved[0].position - moved[1].position) / (2.0 * step)
        turned = np.einsum("bij,bkj->bik", moved[0].rotation - moved[1].rotation, poses.rotation) / (2.0 * step)
        jacobian[:, 3:, j] = np.stack([turned[:, 2, 1], turned[:, 0, 2], turned[:, 1, 0]], axis=1)
    memory.linear_end[:], memory.angular_end[:] = np.random.default_rng(2).normal(size=(2, links, 3))
    wanted = np.hstack([memory.linear_end, memory.angular_end]).ravel()
    weights = np.hstack([
        np.tile(1.0 / memory.masses.inverse_mass[:, None], (1, 3)), np.tile(memory.inertia[:, :1, 0], (1, 3)),
    ]).ravel()
    weigh_linkages(world.dynamics, poses, memory, np.arange(links), h)
    return world, memory, jacobian.reshape(6 * links, degrees), weights, wanted


def avatars() -> list[tuple[Avatar, TrackerSample]]:
    """Return a gripper of hinges, and a person with ball joints in a posture off their zero."""
    grip, human = gripper(1), humanoid()
    turned = {"right_shoulder": (-5.0, -60.0, 20.0), "chest": (10.0, 20.0, 5.0)}
    bent = posed(human, standing(human), turned, {"right_elbow": (40.0,)})
    return [(grip.avatar, grip.sample(0.3)), (human, bent)]


@pytest.mark.parametrize("which", [0, 1])
def test_joints_leave_the_nearest_velocities_that_they_allow(which: int) -> None:
    """Weighted least squares with the Jacobian by differences; a contact pushes all links by J M^-1 J'."""
    world, memory, jacobian, weights, wanted = linkage_of(*avatars()[which], 1e-6)
    links, root, contacts = np.arange(len(world.skeleton.kind)), np.sqrt(weights), memory.contacts
    rates = np.linalg.lstsq(root[:, None] * jacobian, root * wanted, rcond=None)[0]
    move_linkages(world.dynamics, world.poses, memory, links)
    free = np.hstack([memory.linear_end, memory.angular_end]).ravel()
    assert free == pytest.approx(jacobian @ rates, abs=1e-7)
    a, b, arms = int(links[-1]), 1, np.array([[0.02, 0.01, -0.03], [0.0, 0.05, 0.01]])
    n = np.array([0.6, 0.0, 0.8])
    add_contact(contacts, a, b, 0, tuple(n), tuple(arms[0]), tuple(arms[1]), 0.0)
    weigh(contacts, memory.masses)
    weigh_links(world.dynamics, world.poses, memory, 0)
    assert contacts.responses.used[0] == 1
    push = np.zeros(len(weights))
    for body, arm, sign in ((a, arms[0], 1.0), (b, arms[1], -1.0)):
        push[6 * body : 6 * body + 6] += sign * np.hstack([n, np.cross(arm, n)])
    response = jacobian @ np.linalg.solve((jacobian.T * weights) @ jacobian, jacobian.T @ push)
    assert contacts.inverse_effective_mass[0, 0] == pytest.approx(push @ response, rel=1e-6)
    lay_out(contacts, memory.masses, 0, 1, memory.linear_end, memory.angular_end)
    show_linkages(world.drive, contacts, memory, links)
    apply_to_links(contacts, 0, (0.5, 0.0, 0.0))
    moved = np.hstack([contacts.motion[:, :3], contacts.motion[:, 4:7]]).ravel()
    touched = np.isin(np.repeat(links, 6), (a, b))
    assert moved[touched] == pytest.approx((free + 0.5 * response)[touched], abs=1e-6)
    assert (moved[~touched] == free[~touched]).all()
    contacts.impulse[0] = 0.5, 0.0, 0.0
    move_linkages(world.dynamics, world.poses, memory, links)
    ended = np.hstack([memory.linear_end, memory.angular_end]).ravel()
    assert ended[touched] == pytest.approx(moved[touched], abs=1e-9)
    assert ended == pytest.approx(free + 0.5 * response, abs=1e-6)


@pytest.mark.parametrize("which", [0, 1])
def test_joints_stop_at_their_limits(which: int) -> None:
    """Over a time so long that limits bind: rates within their bounds, and forces on degrees at a limit alone, inward."""
    world, memory, _, _, _ = linkage_of(*avatars()[which], 1.0)
    linkage = world.drive.linkage
    move_linkages(world.dynamics, world.poses, memory, np.arange(len(world.skeleton.kind)))
    rate, bounds, held = linkage.rate, linkage.bounds, linkage.at_limit == 1
    assert held.any()
    assert (rate >= bounds[:, 0] - 1e-9).all() and (rate <= bounds[:, 1] + 1e-9).all()
    left = linkage.momentum - linkage.matrix @ rate
    assert left[~held] == pytest.approx(0.0, abs=1e-8)
    at_most = np.abs(rate - bounds[:, 1]) < 1e-9
    assert (left[held & at_most] >= 0.0).all() and (left[held & ~at_most] <= 0.0).all()


def test_ball_joints_linearise_their_limits() -> None:
    """A small turn changes the twist by its gradient, and the room to the edges of cone and polygon by the axes inward; the
    nearer of two edges is the first."""
    world = build(Scene("ball", (), (humanoid(),)))
    skel, random, seen = world.skeleton, np.random.default_rng(4), 0
    balls = [link for link in range(len(skel.kind)) if skel.kind[link] == BALL]
    for _ in range(400):
        link = int(random.choice(balls))
        turn = columns(Rotation.from_rotvec(random.normal(scale=0.4, size=3)).as_matrix()[None], 0)
        room, inward, second, across = room_of_ball(skel.balls, link, turn)
        if room < 1e-3 or cone_excess(skel.balls, link, turn) > 0.0:
            continue
        assert room <= second
        step = 1e-5 * random.normal(size=3)
        turned = columns((Rotation.from_rotvec(step).as_matrix() @ np.array(turn).T)[None], 0)
        after, twists = room_of_ball(skel.balls, link, turned), [room_of_twist(skel.balls, link, one) for one in (turn, turned)]
        assert twists[1][1] - twists[0][1] == pytest.approx(-step @ twists[0][2], abs=1e-7)
        expected = room + step @ inward, second + step @ across
        if abs(after[0] - expected[0]) < 1e-7 and abs(after[2] - expected[1]) < 1e-7:
            seen += 1
        else:
            # another edge is nearer now
            assert after[0] < expected[0] + 1e-7 or abs(expected[0] - expected[1]) < 1e-4
    assert seen > 100


def test_a_ball_at_its_limit_turns_where_linearised_it_may() -> None:
    """At an edge of cone, polygon or twist, where clipping leaves a ball: a small turn within the linearised limits stays inside,
    but for corners where three limits meet, of which two are linearised."""
    world = build(Scene("ball", (), (humanoid(),)))
    skel, random, corners = world.skeleton, np.random.default_rng(8), 0
    balls = [link for link in range(len(skel.kind)) if skel.kind[link] == BALL and has_cone(skel.balls, link)]
    for _ in range(500):
        link = int(random.choice(balls))
        outside = columns(Rotation.random(random_state=random).as_matrix()[None], 0)
        turn = inside_cone(skel.balls, link, outside)
        if turn == outside:
            continue
        room, inward, second, across = room_of_ball(skel.balls, link, turn)
        least, most, gradient = room_of_twist(skel.balls, link, turn)
        assert min(room, -least, most) == pytest.approx(0.0, abs=1e-8)
        limits = [(inward, -room), (across, -min(second, 1.0)), (gradient, least), (neg(gradient), -most)]
        step = 1e-5 * random.normal(size=3)
        for normal, bound in 100 * limits:
            step += max(0.0, bound - np.dot(normal, step)) * np.array(normal) / max(1e-12, np.dot(normal, normal))
        turned = columns((Rotation.from_rotvec(step).as_matrix() @ np.array(turn).T)[None], 0)
        corners += cone_excess(skel.balls, link, turned) > 1e-7
    assert corners < 0.02 * 500
