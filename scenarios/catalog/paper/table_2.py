"""Table 2 and Figure 8 of the paper: an avatar in the gallery pushes into a wall, a corner or itself, again and again.

The pushes have the minimum-jerk profile of human reaching, are drawn by the seed, and never occur twice alike. The lengths are
the paper's; quick comparisons take their beginning.
"""

import math
from collections.abc import Callable

from numpy.random import Generator

from avatarsim.scene.tracker import TrackerSample
from scenarios.building.gallery import gallery, inside
from scenarios.building.stage import with_human
from scenarios.motion.keyframes import Pose, pushes
from scenarios.scenario import Scenario

SPREAD = 6.0
"""Standard deviation [degrees] of the differences between pushes."""
AT_WALL = (-4.6, 1.0, math.pi)
"""Half an arm's length before the west wall, whose face is at x = -5: x, y [m] and heading [rad]."""
AT_CORNER = (2.58, -2.66, math.radians(225.0))
"""Before the corner of the screen (x = 2.1) and the south wall (y = -3)."""
IN_THE_OPEN = (-2.5, -1.8)
Draw = Callable[[Pose, Generator], TrackerSample]


def two_arms(pose: Pose, random: Generator) -> TrackerSample:
    """Return whole arms forward, hands a little apart; a positive turn about x moves a hanging left arm outwards."""
    lift, spread, elbow, lean = random.normal((-85.0, 8.0, 12.0, 6.0), SPREAD)
    turned = {"left_shoulder": (spread, lift, 0.0), "right_shoulder": (-spread, lift + random.normal(0.0, SPREAD), 0.0)}
    bent = {"left_elbow": (abs(elbow),), "right_elbow": (abs(elbow + random.normal(0.0, SPREAD)),)}
    return pose({**turned, "chest": (0.0, abs(lean), 0.0)}, bent)


def arms_and_leg(pose: Pose, random: Generator) -> TrackerSample:
    """Return both arms and, left and right by turns, one knee lifted and its foot kicked."""
    lift, spread, elbow, thigh, knee = random.normal((-80.0, 8.0, 15.0, -65.0, -25.0), SPREAD)
    leg = "left" if random.random() < 0.5 else "right"
    turned = {"left_shoulder": (spread, lift, 0.0), "right_shoulder": (-spread, lift + random.normal(0.0, SPREAD), 0.0)}
    bent = {"left_elbow": (abs(elbow),), "right_elbow": (abs(elbow),), f"{leg}_knee": (min(knee, 0.0),)}
    return pose({**turned, f"{leg}_hip": (0.0, thigh, 0.0)}, bent)


def half_way_back(pose: Pose, random: Generator) -> TrackerSample:
    """Return both arms half-way back."""
    lift, elbow = random.normal((-20.0, 70.0), SPREAD)
    turned = {"left_shoulder": (15.0, lift, 0.0), "right_shoulder": (-15.0, lift, 0.0)}
    return pose(turned, {"left_elbow": (elbow,), "right_elbow": (elbow,)})


def into_itself(pose: Pose, random: Generator) -> TrackerSample:
    """Return one of four ways into oneself."""
    a, b, c = random.normal(0.0, SPREAD, 3)
    way = random.integers(4)
    if way == 0:
        # hands clapped: arms forward and each 25 degrees beyond the middle
        turned = {"left_shoulder": (a, -70.0 + b, -30.0 + c), "right_shoulder": (a, -70.0 - b, 30.0 + c)}
        return pose(turned, {"left_elbow": (25.0,), "right_elbow": (25.0,)})
    if way == 1:
        # arms folded: upper arms a little forward, forearms across the chest and into it
        turned = {"left_shoulder": (a, -25.0 + b, -70.0 + c), "right_shoulder": (a, -25.0 - b, 70.0 + c)}
        return pose(turned, {"left_elbow": (100.0 + a,), "right_elbow": (100.0 + b,)})
    if way == 2:
        # both hands into the thighs
        turned = {"left_shoulder": (-12.0 + a, -15.0 + b, 0.0), "right_shoulder": (12.0 - a, -15.0 + c, 0.0)}
        return pose(turned, {"left_elbow": (15.0,), "right_elbow": (15.0,)})
    # one leg swung through the other
    return pose({"left_hip": (-28.0 + a, 0.0, 0.0), "right_hip": (5.0, b, 0.0)}, {"left_knee": (-20.0,)})


def apart(pose: Pose, random: Generator) -> TrackerSample:
    """Return arms and legs apart."""
    lift, elbow = random.normal((-20.0, 40.0), SPREAD)
    turned = {"left_shoulder": (22.0, lift, 0.0), "right_shoulder": (-22.0, lift, 0.0)}
    return pose(turned, {"left_elbow": (elbow,), "right_elbow": (elbow,)})


def into_corner(pose: Pose, random: Generator) -> TrackerSample:
    """Return the right arm, now more into one wall, now more into the other."""
    lift, aside, elbow, lean = random.normal((-80.0, 15.0, 8.0, 5.0), (10.0, 18.0, SPREAD, SPREAD))
    return pose({"right_shoulder": (0.0, lift, aside), "chest": (0.0, abs(lean), 0.0)}, {"right_elbow": (abs(elbow),)})


def drawn_back(pose: Pose, random: Generator) -> TrackerSample:
    """Return the right arm drawn back."""
    lift, elbow = random.normal((-15.0, 90.0), SPREAD)
    return pose({"right_shoulder": (-15.0, lift, 0.0)}, {"right_elbow": (elbow,)})


def again(
    name: str, title: str, judged: str, ready: Draw, push: Draw, at: tuple[float, ...], frames: int, family: str = "",
) -> Scenario:
    """Return the gallery, and the humanoid in it."""
    return with_human(
        name, title, judged, pushes(ready, push, frames), gallery, at, frames=frames, short=600, region=inside("human/*"),
        family=family,
    )


SCENARIOS = (
    again(
        "two_arms", "Two arms are pushed into a wall of the gallery, again and again.",
        "Overlap; the right side of the wall; Table 2's columns; the frame's cost, which rises as a push begins.",
        half_way_back, two_arms, AT_WALL, 1496,
    ),
    again(
        "self_collision", "An avatar runs into itself, again and again: hands, arms and chest, thighs, legs.",
        "Overlap with itself; limits; offset from the user; Table 2's columns.", apart, into_itself, IN_THE_OPEN, 2327,
    ),
    again(
        "two_arms_and_leg", "Two arms and a leg are pushed into a wall of the gallery, again and again.",
        "Overlap; the right side of the wall; Table 2's columns.", half_way_back, arms_and_leg, AT_WALL, 2440, "two_arms",
    ),
    again(
        "arm_in_corner", "An arm is pushed into a corner of two walls of the gallery, again and again.",
        "Overlap; the right side of both walls; Table 2's columns.", drawn_back, into_corner, AT_CORNER, 2146,
    ),
)
