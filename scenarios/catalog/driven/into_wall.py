"""Rigid hands and balls are led into walls: ten centimetres deep, a box between, as fast as 20 m/s, and round in a bowl."""

from math import cos, pi, sin

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, ConvexHull, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.cases import driven, fixture, loose
from scenarios.building.promises import FOLLOWS_WHEN_FREE, HAND
from scenarios.building.scenes import before
from scenarios.building.stage import HIGH, SPAN, THICK, floor, wall_ahead
from scenarios.motion.keyframes import Key
from scenarios.motion.rigid_hands import hands_at, keyed, led_through, turned_hand
from scenarios.scenario import INFINITE, RENDERED, Bound, Motion, Region, Scenario

RADIUS, FACE, DEEP = 0.05, 0.3, 0.1
"""Radius of the ball, where its wall begins along x, and how far it is led into the wall [m]."""
EDGE, BOX_AT, BOX_FACE, PRESSED = 0.2, 0.35, 0.6, 0.08
"""Edge of the box, where its middle is at first and where its wall begins along x, how far the user presses beyond [m]."""
PALM, FIRST = (0.04, 0.12, 0.12), 0.1
"""Edges of the flat palm that presses it, and where it begins [m]."""
FRAMES, CYCLE = 300, 50
"""Frames of the thrown hand; of a thrust: there, a while behind the wall, back, a while before it."""
SIDES, FOOT, RIM, SHELL, DEPTH = 12, 0.22, 0.30, 0.03, 0.25
"""Straight pieces of the bowl's side, inner radius at the bottom and at the rim, thickness, depth to z = 0, the bottom [m]."""
MIDDLE, ROUND = 0.047, 0.176
"""Distance of a hand's origin behind the middle between wrist and fingertips, and of that middle from the bowl's on its way
round [m]: fingertips ahead, 4 cm into the side, which is less thick."""
THIN, START, BEHIND = 2e-3, -0.35, 0.4
"""Thickness of its wall, where the hand rests before it, and how far it is driven behind it [m]."""
FAST = Bound(
    "tracker_offset_rms_free", 15e-3, "its user comes out at up to 20 m/s: from rest it lags by v / (e omega) = 0.15 m at first"
)


def at_ball(x: float, y: float) -> Vector:
    """Return a place of the ball."""
    return x, y, 0.5 * HIGH


def at_palm(x: float, y: float) -> Vector:
    """Return a place of the palm."""
    return x, y, 0.5 * EDGE


INSIDE, AT_WALL = FACE - RADIUS + DEEP, BOX_FACE - EDGE - 0.5 * PALM[0]
# never straight in: for motion along the normal alone the right answer is not to move
BALL_KEYS = (
    (0.6, at_ball(INSIDE, 0.1)), (1.0, at_ball(INSIDE, 0.2)), (2.0, at_ball(INSIDE, 0.6)), (2.6, at_ball(0.0, 0.5)),
    (3.0, at_ball(0.0, 0.3)),
)
PALM_KEYS = (
    (0.8, at_palm(AT_WALL, 0.005)), (1.1, at_palm(AT_WALL + PRESSED, 0.0)), (1.5, at_palm(AT_WALL + 0.9 * PRESSED, -0.02)),
    (1.9, at_palm(AT_WALL - 0.05, 0.0)), (2.5, at_palm(FIRST, 0.0)), (3.2, at_palm(AT_WALL, 0.02)),
    (3.5, at_palm(AT_WALL + PRESSED, 0.03)), (3.8, at_palm(AT_WALL - 0.05, 0.0)), (5.0, at_palm(FIRST, 0.1)),
)


def thrusts(scene: Scene, seed: int) -> Motion:
    """Return a motion of thrusts, each from another side and faster than the one before: 2 to 20 m/s."""
    count = FRAMES // CYCLE
    speeds = np.geomspace(2.0, 20.0, count)
    aims = np.random.default_rng(seed).uniform(-0.3, 0.3, (count, 2))

    def sample(frame: int) -> TrackerSample:
        k = min(frame // CYCLE, count - 1)
        inside = frame - k * CYCLE + 1
        # at the stated speed to the far end, there until half-time, at the same speed back
        takes = int(np.ceil((BEHIND - START) / (speeds[k] * RENDERED)))
        way = min(inside, max(CYCLE // 2 - inside + takes, 0)) * RENDERED * speeds[k]
        share = float(np.clip(way / (BEHIND - START), 0.0, 1.0))
        y, yaw = share * aims[k] * (1.0, 2.0)
        # a hand trembles: it never rests altogether
        x = START + share * (BEHIND - START) + 2e-3 * np.sin(0.9 * frame)
        return turned_hand((x, float(y), 0.5 * HIGH), float(yaw), (frame + 1) * RENDERED)

    return sample


def bowl() -> Body:
    """Return the bottom, and twelve flat segments that lean outwards."""
    around = [2.0 * pi * k / SIDES for k in range(SIDES + 1)]
    bottom = [[(FOOT + SHELL) * cos(a), (FOOT + SHELL) * sin(a), z] for a in around[:-1] for z in (-SHELL, 0.0)]
    pieces = [Piece(ConvexHull(np.array(bottom)))]
    for a, b in zip(around[:-1], around[1:], strict=True):
        ends = [(FOOT, 0.0), (FOOT + SHELL, 0.0), (RIM, DEPTH), (RIM + SHELL, DEPTH)]
        pieces.append(Piece(ConvexHull(np.array([[r * cos(t), r * sin(t), z] for t in (a, b) for r, z in ends]))))
    return fixture("bowl", tuple(pieces), "wood")


def in_bowl(x: float, y: float, z: float, turn: float) -> TrackerSample:
    """Return the hand with its middle over (x, y), its fingers at the angle `turn` [rad]."""
    return turned_hand((x - MIDDLE * cos(turn), y - MIDDLE * sin(turn), z), turn)


def stirring() -> list[Key]:
    """Return keys down into the bottom, round along the side, up and out."""
    turns = [2.0 * pi * k / 6 for k in range(7)]
    return [
        (0.7, in_bowl(0.0, 0.0, -0.014, 0.0)), (1.0, in_bowl(0.02, 0.01, -0.014, 0.3)),
        *((1.4 + 0.3 * k, in_bowl(ROUND * cos(turn), ROUND * sin(turn), 0.05, turn)) for k, turn in enumerate(turns)),
        (3.5, in_bowl(0.0, 0.0, 0.12, 2.0 * pi)), (4.0, in_bowl(0.1, 0.0, DEPTH + 0.15, 2.0 * pi)),
    ]


SCENARIOS = (
    Scenario(
        "driven_10cm_wall", "A driven ball is led ten centimetres into a wall, along it, and back.",
        "Overlap while it is held, offset once the way is free.",
        lambda: Scene("driven_10cm_wall", (wall_ahead(FACE),), (driven("hand", Sphere(RADIUS), 0.46),),
                      start=hands_at((at_ball(0.0, 0.0),))),
        led_through(BALL_KEYS, 180), 180, bounds=HAND, regions=(before(FACE + 0.5 * THICK, "hand"),),
    ),
    Scenario(
        "squeeze", "A driven hand presses a box against a wall, further than there is room.",
        "Overlap; that the box stays in the room and the hand on its side of it; where the box ends; energy.",
        lambda: Scene(
            "squeeze",
            (floor(), wall_ahead(BOX_FACE), loose("box", Box((EDGE,) * 3), "wood", 2.0, (BOX_AT, 0.0, 0.5 * EDGE + 1e-4))),
            (driven("hand", Box(PALM), 0.46),), start=hands_at((at_palm(FIRST, 0.0),)),
        ),
        led_through(PALM_KEYS, 300), 300, 150,
        regions=(
            Region(("box",), (0.0, -0.5, 0.0), (BOX_FACE, 0.5, 2.0 * EDGE),
                   "the box can be pushed to the wall, but neither through it, nor into the floor, nor thrown over the hand"),
            before(BOX_FACE + 0.5 * THICK, "hand"),
        ),
        bounds=(
            *HAND,
            Bound("travel_missing", 0.0, "the box is pushed to the wall, 15 cm; a hand that meets nothing leaves it there"),
        ),
        expects={"travel": {"box": BOX_FACE - 0.5 * EDGE - BOX_AT - 0.01}},
    ),
    Scenario(
        "thin_wall_hand", "A rigid hand is driven through a wall of two millimetres, at 2 to 20 m/s.",
        "The right side of the wall, sub-steps included; overlap.",
        lambda: Scene(
            "thin_wall_hand", (fixture("wall", Box((THIN, SPAN, HIGH)), "wood", (0.5 * THIN, 0.0, 0.5 * HIGH)),),
            (rigid_hand(),), start=turned_hand((START, 0.0, 0.5 * HIGH), 0.0),
        ),
        thrusts, FRAMES, bounds=(*(bound for bound in HAND if bound is not FOLLOWS_WHEN_FREE), FAST),
        regions=(before(0.5 * THIN, "hand", reason="the wall is endless: there is no way behind it"),),
    ),
    Scenario(
        "hand_in_bowl", "A rigid hand stirs in a bowl, pressed into its bottom and its side.",
        "Overlap; that the hand stays on the inside; that it follows.",
        lambda: Scene("hand_in_bowl", (bowl(),), (rigid_hand(),), start=in_bowl(0.0, 0.0, DEPTH + 0.15, 0.0)),
        keyed(stirring(), 240), 240, bounds=HAND,
        regions=(Region(("hand",), (-RIM, -RIM, 0.0), (RIM, RIM, INFINITE), "the hand goes neither through side nor bottom"),),
    ),
)
