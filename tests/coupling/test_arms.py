"""Persons with ball joints: both hands lift drawn boxes, and clips go through rooms full of loose things without overlap."""


import numpy as np
import pytest

from avatarsim.collision.scratch import make_scratch
from avatarsim.engine import Settings
from avatarsim.model.joint_limits import cone_excess, has_cone
from avatarsim.model.skeleton import BALL
from avatarsim.model.world import World
from avatarsim.scene.body import ContactLaw, PairTable, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
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
            if skel.kind[link] == BALL and has_cone(skel, link):
                self.excess = max(self.excess, cone_excess(skel, link, columns(world.posture.turn, link)))


def drawn_lift(seed: int) -> Lift:
    """A box of 0.1 to 2 kg that friction can hold with a third to spare."""
    random = np.random.default_rng(seed)
    friction, into = random.uniform(0.5, 1.0), random.uniform(0.02, 0.05)
    mass = min(random.uniform(0.1, 2.0), 2.0 * friction * 1000.0 * into / 9.81 / 1.5)
    box = (random.uniform(0.12, 0.2), random.uniform(0.2, 0.34), random.uniform(0.12, 0.25))
    return Lift(box, mass, friction, random.uniform(0.3, 0.34), random.uniform(0.2, 0.4) * box[2], into, random.uniform(0.9, 1.2))


@pytest.mark.parametrize("seed", range(20))
def test_both_hands_lift_a_drawn_box(seed: int) -> None:
    """It rises with its user, less the sag of m g / 2 K and the rolling of the hands on its sides. Nothing overlaps."""
    lift, engine = drawn_lift(seed), AvatarsimEngine()
    scene = lift.scene()
    engine.load(scene, Settings(), DT)
    judge, rise = Judge(engine._frames.world), 0.0
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
    judge, coupled = Judge(engine._frames.world), 0
    heavy = [k for k, body in enumerate(bodies) if body.mass and body.mass.mass > 5.0]
    for frame in range(240):
        shown = engine.advance(motion(frame), DT).shown
        judge.see()
        coupled += int(engine._frames.world.drive.coupled.any())
        assert np.linalg.norm(shown.velocities[heavy], axis=1).max(initial=0.0) < 8.0
    assert judge.gap > -1e-6 and judge.excess <= 0.0
    assert coupled > 20


def brushed(sample: TrackerSample, seconds: float, wall: float | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Positions of the links (frames, nl, 3) of a person led into a posture within half a second and kept there, and flags of
    frames in which a load moves it; a ball of 10 g falls on the head in the meantime."""
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
        coupled.append(engine._frames.world.drive.coupled.any())
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
