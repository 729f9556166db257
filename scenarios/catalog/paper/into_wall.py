"""An avatar moves into a wall: arm and leg extended (Figure 2 of the paper), sideways with an arm hanging flat, arms crossed.

An arm that hangs almost parallel to a wall meets it with its whole length: a turn about the shoulder is no natural way out, the
body gives way. Chains in contact at once are treated in an order that the paper draws at random; a method without an order
shows equal frames for all seeds of `chain_order`, whose motion is one for all.
"""

from numpy.random import Generator

from avatarsim.scene.body import Body
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.cases import fixture
from scenarios.building.stage import HIGH, SPAN, THICK, before_wall, floor, wall_ahead, with_human
from scenarios.motion.keyframes import Key, Pose, posed, pushes, through
from scenarios.scenario import Motion

FACE, NEAR = 0.75, 0.45
"""Where the wall ahead begins along x, out of reach of arm and leg at the origin, and how far the body moves towards it [m]."""
BESIDE, ASIDE = 0.5, 0.3
"""Where the wall at the user's side begins along y, and how far the user steps towards it [m]: the arm goes about 0.1 m in."""
CLOSE = 0.45
"""Where the wall before the crossed arms begins along x [m]."""
HANGING = {"left_shoulder": (8.0, 0.0, 0.0), "right_shoulder": (-20.0, 0.0, 0.0)}


def forward(pose: Pose, random: Generator) -> TrackerSample:
    """Return the sample forward with arm and leg stretched."""
    lift, thigh = random.normal((-90.0, -45.0), 5.0)
    turned = {"right_shoulder": (-5.0, lift, 0.0), "left_hip": (0.0, thigh, 0.0)}
    return pose(turned, {"right_elbow": (5.0,), "left_knee": (-5.0,)}, (NEAR + random.uniform(-0.1, 0.0), 0.0, 0.02))


def back(pose: Pose, random: Generator) -> TrackerSample:
    """Return the sample back at the origin."""
    return pose({"right_shoulder": (-10.0, random.normal(-40.0, 5.0), 0.0)}, moved=(0.0, 0.0, 0.02))


def sidestep(pose: Pose, random: Generator) -> TrackerSample:
    """Return the sample aside with a hanging arm, now a little forward, now a little back."""
    turned = {**HANGING, "left_shoulder": (8.0, float(random.normal(0.0, 3.0)), 0.0)}
    moved = (float(random.normal(0.0, 0.03)), ASIDE + float(random.uniform(-0.03, 0.0)), 0.0)
    return pose(turned, {"left_elbow": (2.0,)}, moved)


def away(pose: Pose, random: Generator) -> TrackerSample:
    """Return the sample away from the wall."""
    return pose(HANGING, {"left_elbow": (10.0,)}, (float(random.normal(0.0, 0.03)), 0.0, 0.0))


def wall_beside() -> tuple[Body, Body]:
    """Return the floor, and a wall on the left."""
    wall = fixture("wall", Box((SPAN, THICK, HIGH)), "wood", (0.0, BESIDE + 0.5 * THICK, 0.5 * HIGH))
    return floor(), wall


def crossed(scene: Scene, seed: int) -> Motion:
    """Return a motion: arms crossed into the wall, a knee up, the head forward; twice, once with each leg."""
    start, keys = scene.first_sample, list[Key]()
    for k, leg in enumerate(("left", "right")):
        turned = {
            "left_shoulder": (0.0, -80.0, -45.0), "right_shoulder": (0.0, -70.0, 45.0), f"{leg}_hip": (0.0, -75.0, 0.0),
            "neck": (0.0, 40.0, 0.0), "chest": (0.0, 15.0, 0.0),
        }
        bent = {"left_elbow": (15.0,), "right_elbow": (20.0,), f"{leg}_knee": (-60.0,)}
        there = posed(scene.avatars[0], start, turned, bent, (0.1, 0.0, 0.0))
        keys += [(k + 0.4, there), (k + 0.6, there), (k + 1.0, start)]
    return through(start, keys, 120).motion()


SCENARIOS = (
    with_human(
        "avatar_into_wall", "An avatar moves into a wall: the extended arm and a leg are pushed back.",
        "Overlap; the right side of the wall; limits; offset from the user; jumps.", pushes(back, forward, 600),
        lambda: (floor(), wall_ahead(FACE)), frames=600, short=300, region=before_wall(FACE, "human/*"),
    ),
    with_human(
        "parallel_link", "A user sidesteps into a wall, an arm hanging flat along it.",
        "Overlap; the right side of the wall; how far the avatar is from its user; jumps.", pushes(away, sidestep, 600),
        wall_beside, frames=600, short=240, region=before_wall(BESIDE, "human/*", axis=1),
    ),
    with_human(
        "chain_order", "Arms, a leg and the neck are in contact at once; the seed is the engine's alone.",
        "Overlap; the spread of what is shown over the order in which chains are treated.", crossed,
        lambda: (floor(), wall_ahead(CLOSE)), frames=120, region=before_wall(CLOSE, "human/*"),
    ),
)
