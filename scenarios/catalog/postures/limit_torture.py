"""Goals far beyond every limit: each joint of the humanoid is asked for radians more than it can give.

Every joint swings on its own rhythm, elbows and knees backwards, hips and shoulders out of their cones and round their
own axis; twice a second some joint turns round at once. The limits hold exactly, in every frame; beyond them the
tracker is not in the world that the avatar lives in, so limbs also run into each other.

In the 240 frames of a quick comparison the raw motion is inside itself in 234 of them (up to 0.14 m deep).
The twin with 21 hinges is inside itself in all 240 (0.15 m).
"""

from dataclasses import replace

import numpy as np

from avatarsim.scene.joint import Ball, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.mjcf_humanoid import hinged_humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.promises import FINITE, MOVES, NO_OVERLAP, RIGHT_SIDE, WITHIN_LIMITS
from scenarios.building.stage import above_floor, floor
from scenarios.scenario import RENDERED, Motion, Scenario

FRAMES, SHORT = 1200, 240
WIDEST = 2.6
"""Largest rotation [rad] asked of a ball joint: far out of every cone, and short of the antipode."""
BEYOND = 2.0
"""How far beyond both its limits each hinge of the hinged humanoid is asked to turn [rad]."""
BEND = 3.5
"""Largest angle [rad] asked of a hinge, either way; elbows give 0 to 2.6, knees -2.4 to 0."""
FLIP = 31
"""Frames after which one joint, another each time, is asked for the opposite at once."""


def build() -> Scene:
    """The humanoid, a metre above a floor, so that it can kick about."""
    human = humanoid()
    start = standing(human)
    positions = start.positions.copy()
    positions[0, 2] += 1.0
    return Scene("limit_torture", (floor(),), (human,), start=TrackerSample(0.0, positions, start.rotations, start.angles))


def motion(scene: Scene, seed: int) -> Motion:
    """Sines of incommensurate periods on every axis of every joint."""
    human, start, random = scene.avatars[0], scene.first_sample, np.random.default_rng(seed)
    links, hinges = len(human.links), human.hinge_count
    balls = [k for k, link in enumerate(human.links) if isinstance(link.joint, Ball)]
    rates, phases = random.uniform(0.3, 1.1, (links, 3)), random.uniform(0.0, 2.0 * np.pi, (links, 3))
    swings, starts = random.uniform(0.3, 1.1, hinges), random.uniform(0.0, 2.0 * np.pi, hinges)

    def sample(frame: int) -> TrackerSample:
        time = (frame + 1) * RENDERED
        vectors = np.zeros((links, 3))
        asked = np.sin(2.0 * np.pi * rates * time + phases)
        vectors[balls] = WIDEST / np.sqrt(3.0) * asked[balls]
        vectors[balls[(frame // FLIP) % len(balls)]] *= -1.0
        rotations = rotation.from_rotation_vector(vectors)
        rotations[0] = start.rotations[0]
        return TrackerSample(time, start.positions, rotations, BEND * np.sin(2.0 * np.pi * swings * time + starts))

    return sample


def build_hinges() -> Scene:
    """The humanoid of 21 hinges, a metre above a floor."""
    human = hinged_humanoid()
    start = rest((human,))
    positions = start.positions.copy()
    positions[0, 2] = 2.3
    return Scene("limit_torture_hinges", (floor(),), (human,), start=TrackerSample(0.0, positions, start.rotations, start.angles))


def motion_hinges(scene: Scene, seed: int) -> Motion:
    """Sines of incommensurate periods, two radians beyond both limits of every hinge."""
    human, start, random = scene.avatars[0], scene.first_sample, np.random.default_rng(seed)
    limits = [hinge for link in human.links if isinstance(link.joint, Hinges) for hinge in link.joint.hinges]
    middle = np.array([0.5 * (hinge.lower + hinge.upper) for hinge in limits])
    width = np.array([0.5 * (hinge.upper - hinge.lower) for hinge in limits]) + BEYOND
    swings, starts = random.uniform(0.3, 1.1, len(limits)), random.uniform(0.0, 2.0 * np.pi, len(limits))

    def sample(frame: int) -> TrackerSample:
        time = (frame + 1) * RENDERED
        asked = middle + width * np.sin(2.0 * np.pi * swings * time + starts)
        asked[(frame // FLIP) % len(limits)] *= -1.0
        return TrackerSample(time, start.positions, start.rotations, asked)

    return sample


SCENARIO = Scenario(
    name="limit_torture",
    title="Every joint is asked, without rest, for radians more than it can give.",
    judged="Excess over the limits of hinges, swing and twist, exactly zero; overlap with itself.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=(NO_OVERLAP, RIGHT_SIDE, FINITE, WITHIN_LIMITS, *MOVES),
    regions=(above_floor("human/*"),),
)
SCENARIOS = (
    SCENARIO,
    replace(
        SCENARIO, name="limit_torture_hinges", build=build_hinges, motion=motion_hinges,
        title="Each of 21 limited hinges is asked, without rest, for two radians more than it can give.",
    ),
)
