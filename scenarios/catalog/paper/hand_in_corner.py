"""Figure 5 of the paper: a hand slides along the non-convex corner of two walls; a rigid one, and the Shadow hand of 24 hinges.

The user points into the corner, presses some centimetres through both walls at once and slides up and down along it, the hand
swaying from wall to wall and the fingers bending and stretching. In a corner one pass of eq. 1 removes half of the overlap.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.avatars.shadow_hand import bends_finger, shadow_hand
from scenarios.building.cases import fixture
from scenarios.building.promises import AVATAR, HAND
from scenarios.building.stage import HIGH, SPAN, THICK
from scenarios.motion.keyframes import minimum_jerk
from scenarios.scenario import INFINITE, RENDERED, Bound, Motion, Region, Scenario

Array = NDArray[np.float64]

SLIDE, ROUND = 1.0, 120
"""Length [m] and frames of one slide, there or back, with letting go in between."""
INTO, BACK = 0.06, 0.10
"""Depth of the hand in the corner, and distance of the fingertips from it when the user lets go [m]."""
SWAY = 0.25
"""Largest turn of the hand towards either wall [rad]."""
ALONG_X = rotation.from_axis_angle((0.0, 0.0, 1.0), np.pi / 4.0)
"""Turns fingers that point along x into the corner, towards +x and +y, the palm down."""
HALF = float(np.sqrt(0.5))
ALONG_Z = rotation.from_matrix(np.array([[-HALF, 0.0, HALF], [HALF, 0.0, HALF], [0.0, 1.0, 0.0]]))
"""Turns fingers that point along z into the corner, the palm down."""
SMOOTH = Bound("root_jump_max", 0.01, "sliding along a corner is smooth; a jump from wall to wall would be 6 cm")


def sliding(turned: Array, tip: float) -> Callable[[Scene, int], Motion]:
    """Return a motion into the corner, along it, out; again in the other direction."""

    def motion(scene: Scene, seed: int) -> Motion:
        phase = float(np.random.default_rng(seed).uniform(0.0, 1.0))
        hand = scene.avatars[0]

        def sample(frame: int) -> TrackerSample:
            k, share = frame // ROUND, (frame % ROUND + 1) / ROUND
            pressed = float(minimum_jerk(np.clip(np.array([5.0 * share, 5.0 * (1.0 - share)]), 0.0, 1.0)).min())
            slid = float(minimum_jerk(np.array(np.clip((share - 0.15) / 0.7, 0.0, 1.0))))
            up = slid if k % 2 == 0 else 1.0 - slid
            yaw = SWAY * pressed * np.sin(2.0 * np.pi * (2.0 * share + phase))
            # never quite still: a hand held in the air trembles
            away = -tip - BACK + pressed * (BACK + INTO) + 1e-3 * np.sin(1.3 * frame)
            curl = float(np.radians(20.0) * (1.0 - np.cos(2.0 * np.pi * 1.5 * share)))
            return _sample(hand, (frame + 1) * RENDERED, turned, away, 1.0 + SLIDE * up, yaw, curl)

        return sample

    return motion


def _sample(hand: Avatar, time: float, turned: Array, away: float, up: float, yaw: float, curl: float) -> TrackerSample:
    """Return the hand `away` [m] from the corner along its bisector, turned by `yaw` [rad], fingers bent by `curl` [rad]."""
    base = rest((hand,))
    positions, rotations = base.positions.copy(), base.rotations.copy()
    heading = np.pi / 4.0 + yaw
    positions[0] = (away * np.cos(heading), away * np.sin(heading), up)
    rotations[0] = rotation.multiply(rotation.from_axis_angle((0.0, 0.0, 1.0), yaw), turned)
    bends = np.array([bends_finger(link) for link in hand.links if isinstance(link.joint, Hinges)], dtype=bool)
    return TrackerSample(time, positions, rotations, np.where(bends, curl, base.angles))


def in_corner(
    name: str, what: str, hand: Callable[[], Avatar], turned: Array, tip: float, promised: tuple[Bound, ...],
) -> Scenario:
    """Return the scene with this hand, its fingers pointed into the corner by `turned`, its tips `tip` [m] from its origin."""

    def build() -> Scene:
        walls = (
            Piece(Box((THICK, SPAN, HIGH)), (0.5 * THICK, 0.0, 0.5 * HIGH)),
            Piece(Box((SPAN, THICK, HIGH)), (0.0, 0.5 * THICK, 0.5 * HIGH)),
        )
        start = _sample(hand(), 0.0, turned, -tip - BACK, 1.0, 0.0, 0.0)
        return Scene(name, (fixture("walls", walls, "wood"),), (hand(),), start=start)

    return Scenario(
        name, f"{what} is pressed into the corner of two walls and slides along it.",
        "Overlap; the right side of both walls; no jump along the corner.", build, sliding(turned, tip), 600, 240,
        family="hand_in_corner",
        # tighter than the promise of every avatar's root
        bounds=(*(bound for bound in promised if bound.metric != SMOOTH.metric), SMOOTH),
        regions=(
            Region(("hand*",), (-INFINITE, -INFINITE, -INFINITE), (0.5 * THICK, 0.5 * THICK, INFINITE),
                   "nothing goes through the walls; they cannot be walked round"),
        ),
    )


SCENARIOS = (
    in_corner("hand_in_corner", "An articulated hand with its forearm", shadow_hand, ALONG_Z, 0.485, AVATAR),
    in_corner("hand_in_corner_rigid", "A rigid hand of fifteen parts", rigid_hand, ALONG_X, 0.145, HAND),
)
