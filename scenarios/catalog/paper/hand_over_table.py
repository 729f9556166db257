"""Figures 1 and 7 of the paper: a rigid hand wanders through the gallery, slides over a table and back, pushes a ball.

The hand's motion is scripted, reach by reach, with the minimum-jerk profile of human movements. Its first half is idle: nothing
touches. Then the user presses 2 cm deep into the table and slides along it, lifts the hand, slides back, and pushes a wooden
ball over the table, in two goes, until it rolls off.
"""

from collections.abc import Callable

import numpy as np

from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Sphere
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.cases import NOWHERE, loose
from scenarios.building.gallery import TABLE_AT, TABLE_HEIGHT, gallery, inside
from scenarios.building.promises import HAND
from scenarios.building.reach import reach
from scenarios.motion.keyframes import minimum_jerk
from scenarios.motion.resampled import at_rate
from scenarios.motion.rigid_hands import hands_at, turned_hand
from scenarios.scenario import RENDERED, Bound, Motion, Scenario

FRAMES, SHORT = 3653, 900
"""The paper's run, and one with the same phases at four times the pace."""
PRESSED = 0.02
"""Depth to which the user presses into the table [m]."""
BALL_RADIUS, BALL_AT = 0.04, (TABLE_AT[0] - 0.1, TABLE_AT[1] + 0.1)
"""Radius of the ball, and where it lies on the table at first [m]."""
SLIDE_Y = TABLE_AT[1] - 0.25
"""The strip of the table on which the hand slides [m], clear of ball and bookends."""


def waypoints() -> tuple[tuple[float, float, float, float, float], ...]:
    """Return (share of the run at which it is reached, x, y, z [m], yaw [rad]) of the hand, in order."""
    below = float(reach((rigid_hand(),), (hands_at((NOWHERE,)),), (0.0, 0.0, -1.0))[0])
    rests = TABLE_HEIGHT + below
    pressed, over, ball = rests - PRESSED, rests + 0.12, TABLE_HEIGHT + BALL_RADIUS
    near, far = TABLE_AT[0] - 0.55, TABLE_AT[0] + 0.4
    x, y = BALL_AT
    return (
        # idle: from room one through the doorway into room two and back
        (0.00, -3.5, -1.5, 1.2, 0.3), (0.06, -1.2, -1.0, 1.3, 0.5), (0.11, 0.0, 0.0, 1.2, 0.0),
        (0.17, 1.2, 1.0, 1.4, -0.6), (0.24, 1.0, -0.8, 1.3, -1.5), (0.29, 0.0, 0.0, 1.3, -3.0),
        (0.35, -1.0, 1.0, 1.2, -3.5), (0.42, -3.6, 1.2, 1.3, -2.0), (0.47, -3.8, -0.3, 1.2, -0.5),
        (0.50, near, SLIDE_Y, over, 0.0),
        # press, slide, lift, press, slide back, lift
        (0.52, near, SLIDE_Y, pressed, 0.0), (0.66, far, SLIDE_Y, pressed, 0.0), (0.68, far, SLIDE_Y, over, 0.0),
        (0.70, far, SLIDE_Y, over + 0.05, 0.0), (0.72, far, SLIDE_Y, pressed, 0.0),
        (0.86, near, SLIDE_Y, pressed, 0.0), (0.88, near, SLIDE_Y, over, 0.0),
        # behind the ball, one push, back, and a longer one
        (0.90, x - 0.35, y, over, 0.0), (0.91, x - 0.35, y, ball, 0.0), (0.94, x + 0.05, y, ball, 0.0),
        (0.955, x - 0.10, y, ball, 0.0), (1.00, x + 0.55, y, ball, 0.0),
    )


def build() -> Scene:
    """Return the gallery, a ball on its table, the hand in room one."""
    ball = loose("ball", Sphere(BALL_RADIUS), "wood", 0.16, (*BALL_AT, TABLE_HEIGHT + BALL_RADIUS + 1e-4))
    _, x, y, z, yaw = waypoints()[0]
    return Scene("hand_over_table", (*gallery(), ball), (rigid_hand(),), start=turned_hand((x, y, z), yaw))


def motion_over(frames: int) -> Callable[[Scene, int], Motion]:
    """Return the scripted motion with its phases spread over `frames` frames."""

    def motion(scene: Scene, seed: int) -> Motion:
        path = np.array(waypoints())

        def sample(frame: int) -> TrackerSample:
            share = min((frame + 1) / frames, 1.0)
            k = min(int(np.searchsorted(path[:, 0], share, side="right")), len(path) - 1)
            gone = minimum_jerk((share - path[k - 1, 0]) / (path[k, 0] - path[k - 1, 0]))
            _, x, y, z, yaw = (path[k - 1] + gone * (path[k] - path[k - 1])).tolist()
            return turned_hand((x, y, z), yaw, (frame + 1) * RENDERED)

        return sample

    return motion


SCENARIO = Scenario(
    "hand_over_table",
    "A rigid hand of fifteen parts wanders through the gallery, slides over a table and back, and pushes a ball.",
    "Overlap; what the frame costs while idle, while sliding and while the ball is hit; where the ball goes.",
    build, motion_over(FRAMES), FRAMES, SHORT, short_motion=motion_over(SHORT),
    bounds=(
        *HAND, Bound("travel_missing", 0.0, "a hand that meets nothing overlaps nothing; this one pushes the ball before it"),
    ),
    # the last push ends 0.55 m beyond where the ball lay, so it can hardly be nearer
    expects={"travel": {"ball": 0.5}}, regions=(inside("hand", "ball"),), everyday=True,
)
SCENARIOS = (SCENARIO, at_rate(SCENARIO))
