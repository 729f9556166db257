"""Persons and drawn hands that lift, shake and go through loose things: nothing overlaps, limits hold."""

import numpy as np
import pytest

from avatarsim.collision.scratch import make_scratch
from avatarsim.engine import Settings
from avatarsim.model.joint_limits import cone_excess, has_cone
from avatarsim.model.skeleton import BALL
from avatarsim.model.world import World
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from avatarsim.spatial.tangent import columns
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.stage import floor, wall_ahead
from scenarios.catalog.contact.arms_lift import HAND, SINKS, Lift
from scenarios.motion.keyframes import posed, through
from scenarios.motion.mocap import load_clip
from scenarios.motion.track import to_and_fro
from tests.rigid.upper_world import least_gap, wanted_pairs

DT = 1.0 / 60.0
TURNS = 0.4
"""Largest rotation of a forearm during the lift [rad]."""


class Judge:
    """Least gap of a world, and most excess of its ball joints, over the frames seen."""

    def __init__(self, world: World) -> None:
        self.world, self.pairs, self.scratch = world, wanted_pairs(world.geometry), make_scratch()
        self.gap, self.excess = 1.0, -1.0

    def see(self) -> None:
        """Judge the state shown."""
        world, skel = self.world, self.world.skeleton
        self.gap = min(self.gap, least_gap(world.poses.vertices, world.geometry.shapes, self.pairs, self.scratch))
        for link in range(len(skel.kind)):
            if skel.kind[link] == BALL and has_cone(skel.balls, link):
                self.excess = max(self.excess, cone_excess(skel.balls, link, columns(world.posture.turn, link)))


def drawn_lift(seed: int) -> Lift:
    """Return a box of 0.1 to 2 kg that friction can hold with a third to spare."""
    random = np.random.default_rng(seed)
    friction, into = random.uniform(0.5, 1.0), random.uniform(0.02, 0.05)
    mass = min(random.uniform(0.1, 2.0), 2.0 * friction * 1000.0 * into / 9.81 / 1.5)
    box = (random.uniform(0.12, 0.2), random.uniform(0.2, 0.34), random.uniform(0.12, 0.25))
    return Lift(box, mass, friction, random.uniform(0.3, 0.34), random.uniform(0.2, 0.4) * box[2], into, random.uniform(0.9, 1.2))


@pytest.mark.parametrize("seed", range(8))
def test_both_hands_lift_a_drawn_box(seed: int) -> None:
    """It rises with its user, less the sag of m g / 2 K and the rolling of the hands on its sides. Nothing overlaps."""
    lift, engine = drawn_lift(seed), AvatarsimEngine()
    scene = lift.scene()
    engine.load(scene, Settings(), DT)
    judge, rise = Judge(engine._running().world), 0.0
    before = scene.bodies[2].position[2]
    for frame in range(300):
        shown = engine.advance(lift.at((frame + 1) * DT), DT).shown
        judge.see()
        if (frame + 1) * DT < SINKS[0]:
            rise = float(shown.positions[2, 2]) - before
    assert rise == pytest.approx(0.2, abs=9.81 * lift.mass / 2000.0 + HAND * TURNS)
    assert judge.gap > -1e-6 and judge.excess <= 0.0
    assert np.linalg.norm(shown.velocities[2]) < 0.5


@pytest.mark.parametrize("seed", range(6))
def test_clips_go_through_loose_things_without_overlap(seed: int) -> None:
    """Boxes and balls of 0.1 to 20 kg fall around a person; nothing of 5 kg or more is shot away."""
    random, human = np.random.default_rng(seed), humanoid()
    bodies = [floor()]
    count = int(random.integers(4, 10))
    for k in range(count):
        shape = Sphere(random.uniform(0.05, 0.15)) if random.random() < 0.3 else Box(tuple(random.uniform(0.08, 0.4, 3)))
        angle, far = 2.0 * np.pi * k / count, random.uniform(0.5, 0.7)
        place = (far * np.cos(angle), far * np.sin(angle), random.uniform(0.3, 1.6))
        mass = float(np.exp(random.uniform(np.log(0.1), np.log(20.0))))
        bodies.append(simulated(f"thing {k}", (Piece(shape),), "wood", solid((Piece(shape),), mass), place))
    law = ContactLaw(0.0, random.uniform(0.2, 0.9))
    materials = PairTable(dict.fromkeys((("wood", "wood"), ("wood", "human"), ("human", "human")), law))
    scene, engine = Scene("room", tuple(bodies), (human,), materials=materials, start=standing(human)), AvatarsimEngine()
    motion = to_and_fro(load_clip(("kick", "dance_a", "getup_facedown", "crawl", "spinkick", "roll")[seed]), scene, 240)
    engine.load(scene, Settings(), DT)
    judge, coupled = Judge(engine._running().world), 0
    heavy = [k for k, body in enumerate(bodies) if body.mass and body.mass.mass > 5.0]
    for frame in range(240):
        shown = engine.advance(motion(frame), DT).shown
        judge.see()
        coupled += int(engine._running().world.drive.coupled.any())
        assert np.linalg.norm(shown.velocities[heavy], axis=1).max(initial=0.0) < 8.0
    assert judge.gap > -1e-6 and judge.excess <= 0.0
    assert coupled > 20


def brushed(sample: TrackerSample, seconds: float, wall: float | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Return positions of the links (frames, nl, 3) of a person led into a posture within half a second and kept there, and flags
    of frames in which a load moves it; a ball of 10 g falls on the head in the meantime."""
    human = humanoid()
    pieces = (Piece(Sphere(0.05)),)
    ball = simulated("ball", pieces, "wood", solid(pieces, 0.01), (0.02, 0.0, 2.4))
    bodies = (floor(), ball) if wall is None else (floor(), ball, wall_ahead(wall))
    law = ContactLaw(0.5, 0.5)
    materials = PairTable(dict.fromkeys((("wood", "wood"), ("wood", "human"), ("human", "human")), law))
    scene = Scene("brushed", bodies, (human,), materials=materials, start=standing(human))
    engine, seen, coupled = AvatarsimEngine(), [], []
    frames = round(seconds / DT)
    motion = through(scene.first_sample, [(0.5, sample)], frames).motion()
    engine.load(scene, Settings(), DT)
    for frame in range(frames):
        seen.append(engine.advance(motion(frame), DT).shown.positions[len(bodies):].copy())
        coupled.append(engine._running().world.drive.coupled.any())
    return np.array(seen), np.array(coupled)


@pytest.mark.parametrize("into", [0.03, 0.1])
def test_a_person_who_is_released_does_not_leap(into: float) -> None:
    """With both hands in a wall, and long after the ball has gone."""
    human = humanoid()
    start = standing(human)
    arms = posed(human, start, {f"{side}_shoulder": (0.0, -85.0, 0.0) for side in ("left", "right")})
    reach = 0.6
    seen, coupled = brushed(arms, 6.0, reach - into)
    assert coupled.any() and not coupled[-1]
    steps = np.linalg.norm(np.diff(seen, axis=0), axis=2).max(axis=1)
    released = int(np.flatnonzero(coupled)[-1])
    assert steps[released - 2 :].max() < 5e-3


@pytest.mark.parametrize("hip", [(-47.0, 43.0, 31.0), (-77.0, 64.0, 59.0), (60.0, -86.0, 10.0)])
def test_a_leg_beyond_its_reach_rests(hip: tuple[float, float, float]) -> None:
    """Its user holds it still beyond two edges of its reach cone, while a load moves the person."""
    human = humanoid()
    seen, coupled = brushed(posed(human, standing(human), {"right_hip": hip}), 3.3)
    assert coupled[160:].all()
    assert np.linalg.norm(np.diff(seen[160:], axis=0), axis=2).sum(axis=0).max() < 1e-2


def hand(random: np.random.Generator) -> Avatar:
    """Return a palm and two to four fingers of one to three hinges, which may bend into each other."""
    palm = (Piece(Box((0.1, 0.1, 0.02))),)
    links = [Link("palm", None, Free(), palm, solid(palm, random.uniform(0.2, 1.0)), "m")]
    for finger in range(int(random.integers(2, 5))):
        angle = 0.5 * np.pi * finger + random.uniform(-0.3, 0.3)
        x, y, parent = float(np.cos(angle)), float(np.sin(angle)), "palm"
        anchor = (0.06 * x, 0.06 * y, -0.011)
        for joint in range(int(random.integers(1, 4))):
            length = random.uniform(0.025, 0.05)
            bone = Piece(Capsule(0.007, length), (0.0, 0.0, -0.5 * length - 0.009))
            if random.random() < 0.3:
                bone = Piece(Box((0.012, 0.012, length)), (0.0, 0.0, -0.5 * length - 0.003))
            bend, name = Hinges((Hinge((y, -x, 0.0), -0.9, 0.9),)), f"finger {finger} {joint}"
            links.append(Link(name, parent, bend, (bone,), solid((bone,), random.uniform(0.01, 0.1)), "m", anchor))
            parent, anchor = name, (0.0, 0.0, -length - 0.02)
    return Avatar("hand", tuple(links))


def things(random: np.random.Generator) -> list[Body]:
    """Return one to three balls, boxes and hulls of 10 g to 2 kg above each other."""
    found = []
    for k in range(int(random.integers(1, 4))):
        corners = random.normal(size=(14, 3))
        hull = ConvexHull(0.04 * corners / np.linalg.norm(corners, axis=1)[:, None])
        shape = (Sphere(random.uniform(0.02, 0.04)), Box(tuple(random.uniform(0.03, 0.08, 3))), hull)[random.integers(3)]
        mass = float(np.exp(random.uniform(np.log(0.01), np.log(2.0))))
        place = (random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), 0.06 + 0.1 * k)
        found.append(simulated(f"thing {k}", (Piece(shape),), "m", solid((Piece(shape),), mass), place))
    return found


@pytest.mark.parametrize("seed", [*range(8), 308, 372])
def test_drawn_hands_overlap_nothing(seed: int) -> None:
    random = np.random.default_rng(seed)
    avatar, bodies = hand(random), things(random)
    angles = random.uniform(-0.9, 0.9, len(avatar.links) - 1)
    often, far, noise = random.uniform(0.5, 3.0), random.uniform(0.02, 0.15), (0.0, 3e-4, 1e-3)[seed % 3]

    def sample(time: float) -> TrackerSample:
        shakes = far if time > 1.0 else 0.0
        places = np.zeros((len(avatar.links), 3))
        high = 0.6 - 0.4 * min(time, 1.0) + 0.5 * shakes * np.sin(6.0 * often * time)
        places[0] = shakes * np.sin(3.0 * often * time), 0.0, high
        places[0] += noise * random.normal(size=3)
        turns = np.tile(rotation.IDENTITY, (len(avatar.links), 1))
        turns[0] = rotation.from_axis_angle((0.0, 1.0, 0.0), 0.8 * np.sin(2.0 * time) if time > 1.0 else 0.0)
        return TrackerSample(time, places, turns, angles * (0.5 - 0.5 * np.cos(3.0 * time)))

    floor = fixed("floor", (Piece(Box((3.0, 3.0, 0.2))),), "m", (0.0, 0.0, -0.1))
    law = PairTable({("m", "m"): ContactLaw(0.5 * (seed % 2), random.uniform(0.2, 0.9))})
    engine, dt = AvatarsimEngine(), (1.0 / 30.0, 1.0 / 60.0, 1.0 / 90.0, 1.0 / 240.0)[seed % 4]
    engine.load(Scene("drawn", (floor, *bodies), (avatar,), materials=law, start=sample(0.0)), Settings(), dt)
    judge = Judge(engine._running().world)
    for k in range(round(2.5 / dt)):
        shown = engine.advance(sample((k + 1) * dt), dt).shown
        judge.see()
        assert np.isfinite(shown.positions).all() and judge.gap >= -1e-6
