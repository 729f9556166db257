"""A tracker gives postures beyond every limit: without rest, or with jumps to any place and posture of a room.

Every joint swings on its own rhythm, elbows and knees backwards, hips and shoulders out of their cones and round their own
axis; twice a second some joint turns round at once. Or every half second the user is elsewhere in room one of the gallery, up
to half a metre beyond its walls, every joint drawn anew. Limits hold exactly; limbs also run into each other.
"""

import numpy as np

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Ball, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.mjcf_humanoid import hinged_humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.gallery import gallery, inside
from scenarios.building.promises import MOVES, SOUND, WITHIN_LIMITS
from scenarios.building.stage import above_floor, floor, with_human
from scenarios.scenario import RENDERED, Motion, Scenario

WIDEST, BEND = 2.6, 3.5
"""Largest target rotation of a ball joint, short of the antipode, and largest target angle of a hinge, either way [rad]."""
BEYOND = 2.0
"""Angle beyond both limits to which each hinge of the hinged humanoid is led [rad]."""
FLIP = 31
"""Frames after which the target of one joint, another each time, is reversed at once."""
PLACES, HELD = ((-5.5, -3.5, 0.7), (0.2, 3.5, 1.3)), 30
"""Corners of the box from which the root's place is drawn [m]: room one and its surroundings; frames between two jumps."""
BOUNDS = (*SOUND, WITHIN_LIMITS, *MOVES)


def hinges_of(avatar: Avatar) -> list[Hinge]:
    """Return all hinges, in order."""
    return [hinge for link in avatar.links if isinstance(link.joint, Hinges) for hinge in link.joint.hinges]


def swinging(scene: Scene, seed: int) -> Motion:
    """Return sines of incommensurate periods on every axis of every joint."""
    human, start, random = scene.avatars[0], scene.first_sample, np.random.default_rng(seed)
    links, hinges = len(human.links), human.hinge_count
    balls = [k for k, link in enumerate(human.links) if isinstance(link.joint, Ball)]
    rates, phases = random.uniform(0.3, 1.1, (links, 3)), random.uniform(0.0, 2.0 * np.pi, (links, 3))
    swings, starts = random.uniform(0.3, 1.1, hinges), random.uniform(0.0, 2.0 * np.pi, hinges)

    def sample(frame: int) -> TrackerSample:
        time = (frame + 1) * RENDERED
        vectors = np.zeros((links, 3))
        vectors[balls] = WIDEST / np.sqrt(3.0) * np.sin(2.0 * np.pi * rates * time + phases)[balls]
        vectors[balls[(frame // FLIP) % len(balls)]] *= -1.0
        rotations = rotation.from_rotation_vector(vectors)
        rotations[0] = start.rotations[0]
        return TrackerSample(time, start.positions, rotations, BEND * np.sin(2.0 * np.pi * swings * time + starts))

    return sample


def swinging_hinges(scene: Scene, seed: int) -> Motion:
    """Return sines of incommensurate periods, two radians beyond both limits of every hinge."""
    start, random, limits = scene.first_sample, np.random.default_rng(seed), hinges_of(scene.avatars[0])
    middle = np.array([0.5 * (hinge.lower + hinge.upper) for hinge in limits])
    width = np.array([0.5 * (hinge.upper - hinge.lower) for hinge in limits]) + BEYOND
    swings, starts = random.uniform(0.3, 1.1, len(limits)), random.uniform(0.0, 2.0 * np.pi, len(limits))

    def sample(frame: int) -> TrackerSample:
        time = (frame + 1) * RENDERED
        angles = middle + width * np.sin(2.0 * np.pi * swings * time + starts)
        angles[(frame // FLIP) % len(limits)] *= -1.0
        return TrackerSample(time, start.positions, start.rotations, angles)

    return sample


def jumping(scene: Scene, seed: int) -> Motion:
    """Return a new place and posture every half second, up to a radian beyond hinge limits; slow in between."""
    human, limits = scene.avatars[0], hinges_of(scene.avatars[0])
    balls = np.array([isinstance(link.joint, Ball) for link in human.links])

    def sample(frame: int) -> TrackerSample:
        random = np.random.default_rng((seed, frame // HELD))
        positions = np.zeros((len(human.links), 3))
        positions[0] = random.uniform(*PLACES)
        vectors = np.where(balls[:, None], random.uniform(-1.2, 1.2, (len(human.links), 3)), 0.0)
        vectors[0] = random.uniform(-0.4, 0.4, 2).tolist() + [random.uniform(-np.pi, np.pi)]
        angles = np.array([random.uniform(hinge.lower - 1.0, hinge.upper + 1.0) for hinge in limits])
        sway = 0.05 * np.sin(2.0 * np.pi * (frame % HELD) / HELD)
        vectors[balls] += sway
        return TrackerSample((frame + 1) * RENDERED, positions, rotation.from_rotation_vector(vectors), angles + sway)

    return sample


def hanging(name: str, human: Avatar, start: TrackerSample, height: float) -> Scene:
    """Return an avatar in the air over a floor, its root at a `height` [m], so that it can kick about."""
    positions = start.positions.copy()
    positions[0, 2] = height
    return Scene(name, (floor(),), (human,), start=TrackerSample(0.0, positions, start.rotations, start.angles))


def ball_joints() -> Scene:
    """Return the humanoid, a metre above its first posture."""
    start = standing(humanoid())
    return hanging("limit_torture", humanoid(), start, float(start.positions[0, 2]) + 1.0)


LIMITS = "Excess over the limits of hinges, swing and twist, exactly zero; overlap with itself."
SCENARIOS = (
    Scenario(
        "limit_torture", "Every joint is asked, without rest, for radians more than it can give.", LIMITS,
        ball_joints, swinging, 1200, 240, bounds=BOUNDS, regions=(above_floor("human/*"),),
    ),
    Scenario(
        "limit_torture_hinges", "Each of 21 limited hinges is asked, without rest, for two radians more than it can give.",
        LIMITS, lambda: hanging("limit_torture_hinges", hinged_humanoid(), rest((hinged_humanoid(),)), 2.3), swinging_hinges,
        1200, 240, bounds=BOUNDS, regions=(above_floor("human/*"),), family="limit_torture",
    ),
    with_human(
        "teleport",
        "The tracker jumps every half second to another place and posture, into walls, furniture and the body itself.",
        "Overlap, the right side of every wall, limits. The avatar may go as far as its user leaps, but through nothing.",
        jumping, gallery, (-2.5, -1.8), frames=600, short=240, bounds=BOUNDS, region=inside("human/*"),
    ),
)
