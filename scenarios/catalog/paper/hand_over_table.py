"""Figures 1 and 7 of the paper: a rigid hand wanders through the gallery, slides over a table and back, pushes a ball.

The hand is tracked; its motion is scripted, reach by reach, each with the minimum-jerk profile of human point-to-point
movements. Its first half is idle: nothing touches. Then the user presses 2 cm deep into the table and slides along it,
lifts the hand, slides back, and pushes a wooden ball over the table, in two goes, until it rolls off.
The raw motion is 2 cm inside the table in 30 % of the frames and passes through the ball where it lay; idle, it is free.
"""

from collections.abc import Callable

import numpy as np

from avatarsim.scene.body import Body, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.gallery import TABLE_AT, TABLE_HEIGHT, gallery, inside
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, MOVES, NO_OVERLAP, RIGHT_SIDE
from scenarios.building.reach import reach
from scenarios.motion.resampled import at_rate
from scenarios.scenario import RENDERED, Bound, Motion, Scenario

FRAMES, SHORT = 3653, 900
"""The paper's run, and one with the same phases at four times the pace."""
PRESSED = 0.02
"""How deep the user presses into the table [m]."""
BALL_RADIUS = 0.04
"""Radius of the ball [m]."""
BALL_MASS = 0.16
"""Mass of the ball [kg]: wood of 600 kg per cubic metre."""
BALL_AT = (TABLE_AT[0] - 0.1, TABLE_AT[1] + 0.1)
"""Where the ball lies on the table at first [m]."""
BALL_GAP = 1e-4
"""Height of the ball over the table at first [m]: a start must be free of overlap beyond any rounding."""
PUSHED = 0.5
"""Least way [m] of the ball: the last push ends 0.55 m beyond where the ball lay, so it can hardly be nearer."""
BALL_PUSHED = Bound("travel_missing", 0.0, "a hand that meets nothing overlaps nothing; this one pushes the ball before it")
SLIDE_Y = TABLE_AT[1] - 0.25
"""The strip of the table on which the hand slides [m], clear of ball and bookends."""


def waypoints() -> tuple[tuple[float, float, float, float, float], ...]:
    """(share of the run at which it is reached, x, y, z [m], yaw [rad]) of the hand, in order."""
    below = float(reach((rigid_hand(),), (_sample(0.0, np.zeros(3), 0.0),), (0.0, 0.0, -1.0))[0])
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
    """The gallery, a ball on its table, the hand in room one."""
    hand = rigid_hand()
    _, x, y, z, yaw = waypoints()[0]
    return Scene("hand_over_table", (*gallery(), _ball()), (hand,), start=_sample(0.0, np.array([x, y, z]), yaw))


def motion_over(frames: int) -> Callable[[Scene, int], Motion]:
    """The scripted motion with its phases spread over `frames` frames."""

    def motion(scene: Scene, seed: int) -> Motion:
        path = np.array(waypoints())

        def sample(frame: int) -> TrackerSample:
            share = min((frame + 1) / frames, 1.0)
            k = min(int(np.searchsorted(path[:, 0], share, side="right")), len(path) - 1)
            u = (share - path[k - 1, 0]) / (path[k, 0] - path[k - 1, 0])
            # minimum jerk (Flash and Hogan 1985): rest to rest, with no jump in speed or acceleration
            eased = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
            _, x, y, z, yaw = path[k - 1] + eased * (path[k] - path[k - 1])
            return _sample((frame + 1) * RENDERED, np.array([x, y, z]), float(yaw))

        return sample

    return motion


def _ball() -> Body:
    pieces = (Piece(Sphere(BALL_RADIUS)),)
    at = (*BALL_AT, TABLE_HEIGHT + BALL_RADIUS + BALL_GAP)
    return simulated("ball", pieces, "wood", solid(pieces, BALL_MASS), at)


def _sample(time: float, position: np.typing.NDArray[np.float64], yaw: float) -> TrackerSample:
    turned = rotation.from_axis_angle((0.0, 0.0, 1.0), yaw)
    return TrackerSample(time, position.reshape(1, 3), turned.reshape(1, 4), np.zeros(0))


SCENARIO = Scenario(
    name="hand_over_table",
    title="A rigid hand of fifteen parts wanders through the gallery, slides over a table and back, and pushes a ball.",
    judged="Overlap; what the frame costs while idle, while sliding and while the ball is hit; where the ball goes.",
    build=build,
    motion=motion_over(FRAMES),
    frames=FRAMES,
    short=SHORT,
    short_motion=motion_over(SHORT),
    bounds=(NO_OVERLAP, RIGHT_SIDE, FINITE, *MOVES, FOLLOWS_WHEN_FREE, BALL_PUSHED),
    expects={"travel": {"ball": PUSHED}},
    regions=(inside("hand", "ball"),),
    everyday=True,
)
SCENARIOS = (SCENARIO, at_rate(SCENARIO))
