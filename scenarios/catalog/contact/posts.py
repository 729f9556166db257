"""A flat hand lifts a box off two posts: it carries the box away (`palm`), or holds still and sags by m g / K (`tray`)."""

from collections.abc import Iterator

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box
from avatarsim.settings import CouplingSettings
from scenarios.building.cases import LAID, driven, fixture, loose, one_law, slab
from scenarios.building.expected import Carried, Sag
from scenarios.building.promises import KEEPS_MOVING, KEEPS_TIME, SOUND
from scenarios.building.scenes import led_hands
from scenarios.motion.rigid_hands import Places, eased
from scenarios.scenario import Bound, Region, Scenario

TOP, ASIDE, BOX = 0.3, 0.1, (0.24, 0.08, 0.06)
"""Height of the posts, how far from the middle they stand, and edges of the box [m]."""
LOW, HIGH = TOP - 0.03, TOP + 0.04
"""Heights of the hand's middle before and after it lifts the box [m]."""
CARRIED_MASS, HELD_MASS = 0.4, 0.3
"""Masses of the box [kg]."""
GOES, TURNS, PUSH = 1.0, 0.5, 2.0
"""From when on the carrying hand goes [s], how long it gains and then loses speed [s], and its acceleration [m/s^2]."""
STILL = 1.5
"""From then on [s] all is still: the spring of equation 6 has lost all but 1e-9 of its swing."""


def bodies(mass: float) -> Iterator[Body]:
    """Floor, two posts, and the box of `mass` [kg] across them."""
    yield slab(8.0, 8.0, "wood")
    for k, x in enumerate((-ASIDE, ASIDE)):
        yield fixture(f"post_{k}", Box((0.04, 0.1, TOP)), "wood", (x, 0.0, 0.5 * TOP))
    yield loose("box", Box(BOX), "box", mass, (0.0, 0.0, TOP + 0.5 * BOX[2] + LAID))


def along(time: float) -> float:
    """Way of the user [m]: constant acceleration, the same backwards, then rest."""
    t = min(max(time - GOES, 0.0), 2.0 * TURNS)
    late = max(t - TURNS, 0.0)
    return 0.5 * PUSH * t * t - PUSH * late * late


def carrying(time: float) -> tuple[Vector]:
    """The hand, which rises and then goes along y, between the posts and away."""
    return ((0.0, along(time), LOW + (HIGH - LOW) * eased(time, 0.1, 0.7)),)


def holding(time: float) -> tuple[Vector]:
    """The hand, which rises and then holds still."""
    return ((0.0, 0.0, LOW + (HIGH - LOW) * eased(time, 0.1, 0.8)),)


def lifted(
    name: str, title: str, judged: str, mass: float, friction: float, places: Places, frames: int, short: int,
    bounds: tuple[Bound, ...], region: Region, expects: dict[str, object],
) -> Scenario:
    """The scene with a box of `mass` [kg] that lies on a led hand between two posts."""
    return led_hands(
        name, title, judged, lambda: bodies(mass), lambda: (driven("hand", Box((0.14, 0.2, 0.02)), 0.5, "hand"),), places,
        one_law(0.0, friction, ("wood", "box"), ("box", "hand")), frames=frames, short=short, family=name,
        bounds=(*SOUND, KEEPS_MOVING, KEEPS_TIME, *bounds), regions=(region,), expects=expects,
    )


SCENARIOS = (
    lifted(
        "palm", "A flat hand lifts a box and carries it away.", "That the box comes along and does not slip.",
        CARRIED_MASS, 0.6, carrying, 300, 140,
        (
            Bound("grip_slip_max", 2e-3, "a third of what friction holds; where acceleration jumps springs yield by 0.5 mm"),
            Bound("height_missing", 1e-3, "the box stays on the hand"),
            Bound("travel_missing", 0.0, "the box comes along: half a metre"),
        ),
        Region(("box", "hand"), (-0.1, -0.1, 0.2), (0.1, 0.7, 0.6), "the box stays on the hand"),
        {"carried": (Carried("box", ("hand",), GOES - 0.05),), "travel": {"box": PUSH * TURNS * TURNS - 0.01}},
    ),
    lifted(
        "tray", "A flat hand lifts a box and holds it still.",
        "How far the hand sags under the load; that the box does not slip.", HELD_MASS, 0.5, holding, 600, 110,
        (
            Bound("sag_error_max", 1e-5, "equation 6 at rest: K times the lag is the load, to a hundredth of a millimetre"),
            Bound("height_missing", 1e-4, "the box stays on the hand"),
            Bound("grip_slip_max", 1e-4, "a box on a hand that holds still lies still"),
        ),
        Region(("box", "hand"), (-0.1, -0.1, 0.2), (0.1, 0.1, 0.6), "the box lies on the hand, and the hand is below its user"),
        {"sags": (Sag("hand", 9.81 * HELD_MASS / CouplingSettings().spring, STILL),),
         "carried": (Carried("box", ("hand",), STILL),)},
    ),
)
