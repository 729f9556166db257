"""Flat hands lift a box off two posts, pinch one between them, and press a coin on a table.

A hand carries its box away (`palm`), or holds still and sags by m g / K (`tray`). Each user of a pinch goes one or two
centimetres into the box, by equation 6 10 or 20 N: the pads hold 4 times the weight of the light box and 2.4 times that of the
heavy one, and sag by m g / 2 K. The coin that a palm presses with 20 N has no reason to go anywhere.
"""

from collections.abc import Iterator
from dataclasses import replace

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box
from avatarsim.settings import CouplingSettings
from scenarios.building.cases import LAID, driven, fixture, loose, one_law, slab
from scenarios.building.expected import Carried, Pressed, Sag
from scenarios.building.promises import KEEPS_MOVING, KEEPS_TIME, SOUND
from scenarios.building.scenes import above, led_hands
from scenarios.building.things import COIN, COIN_MASS, COIN_THICK
from scenarios.motion.rigid_hands import Places, eased
from scenarios.scenario import Bound, Region, Scenario

TOP, ASIDE, BOX = 0.3, 0.1, (0.24, 0.08, 0.06)
"""Height of the posts, their distance from the middle, and edges of the box on them [m]."""
LOW, HIGH = TOP - 0.03, TOP + 0.04
"""Heights of the hand's middle before and after it lifts the box [m]."""
GOES, TURNS, PUSH = 1.0, 0.5, 2.0
"""From when on the carrying hand goes [s], how long it gains and then loses speed [s], and its acceleration [m/s^2]."""
HELD_MASS, STILL = 0.3, 1.5
"""Mass of the box that is held still [kg], and from when on all is still but for 1e-9 of the spring's swing [s]."""

EDGE, PAD = 0.08, (0.02, 0.06, 0.06)
"""Edges of the box that is pinched and of a pad [m]."""
OPEN, BEGINS, RISE = 0.10, 0.05, 0.3
"""Where a pad begins sideways and above [m], and how far both rise."""
CLOSED, UP, LET_GO = (0.1, 0.6), (0.8, 1.8), (2.8, 3.2)
"""When the pads close, rise and open [s]."""

AT = (0.004, 0.003)
"""Where the coin lies: not below the middle of the palm, so that the palm would tilt [m]."""
PALM, OVER, DEEP = (0.1, 0.1, 0.02), 0.04, 0.02
"""Edges of the palm, how high it begins above the coin, and how far its user goes beyond the coin's face [m]."""


def on_posts(mass: float) -> Iterator[Body]:
    """Yield floor, two posts, and the box of `mass` [kg] across them."""
    yield slab(8.0, 8.0, "wood")
    for k, x in enumerate((-ASIDE, ASIDE)):
        yield fixture(f"post_{k}", Box((0.04, 0.1, TOP)), "wood", (x, 0.0, 0.5 * TOP))
    yield loose("box", Box(BOX), "box", mass, (0.0, 0.0, TOP + 0.5 * BOX[2] + LAID))


def carrying(time: float) -> tuple[Vector]:
    """Return the hand, which rises and then goes along y: constant acceleration, the same backwards, then rest."""
    t = min(max(time - GOES, 0.0), 2.0 * TURNS)
    late = max(t - TURNS, 0.0)
    return ((0.0, 0.5 * PUSH * t * t - PUSH * late * late, LOW + (HIGH - LOW) * eased(time, 0.1, 0.7)),)


def pinching(time: float, into: float) -> tuple[Vector, Vector]:
    """Return the pads at +x and -x, which press `into` the box [m]."""
    touching = 0.5 * EDGE + 0.5 * PAD[0]
    x = OPEN - (OPEN - touching + into) * (eased(time, *CLOSED) - eased(time, *LET_GO))
    z = BEGINS + RISE * eased(time, *UP)
    return (x, 0.0, z), (-x, 0.0, z)


def lifted(
    name: str, title: str, judged: str, mass: float, friction: float, places: Places, frames: int, short: int,
    bounds: tuple[Bound, ...], region: Region, expects: dict[str, object],
) -> Scenario:
    """Return the scene with a box of `mass` [kg] that a hand lifts off two posts."""
    return led_hands(
        name, title, judged, lambda: on_posts(mass), lambda: (driven("hand", Box((0.14, 0.2, 0.02)), 0.5, "hand"),), places,
        one_law(0.0, friction, ("wood", "box"), ("box", "hand")), frames=frames, short=short,
        bounds=(*SOUND, KEEPS_MOVING, KEEPS_TIME, *bounds), regions=(region,), expects=expects,
    )


def pinched(name: str, mass: float, into: float) -> Scenario:
    """Return the scene with a box of `mass` [kg], pressed by `into` [m] on either side."""
    sag = 9.81 * mass / (2.0 * CouplingSettings().spring)
    return led_hands(
        name, f"Two pads pinch a box of {mass:g} kg and lift it.", "Overlap; that the box comes along, and does not slip.",
        lambda: (slab(4.0, 4.0), loose("box", Box((EDGE, EDGE, EDGE)), "box", mass, (0.0, 0.0, 0.5 * EDGE + LAID))),
        lambda: (driven("right", Box(PAD), 0.5, "pad"), driven("left", Box(PAD), 0.5, "pad")),
        lambda time: pinching(time, into), one_law(0.0, 0.6, ("pad", "box"), ("pad", "floor"), ("box", "floor")),
        frames=240, short=140, family="pinch",
        bounds=(
            *SOUND, replace(KEEPS_MOVING, limit=5.0), KEEPS_TIME,
            Bound("height_missing", sag + 1e-3, "the box rises with its users, less the sag m g / 2 K, to a millimetre"),
            Bound("grip_slip_max", 1e-4, "within Coulomb's cone nothing slips; springs yield by less as they rise"),
        ),
        regions=(
            Region(("box",), (-0.2, -0.2, 0.0), (0.2, 0.2, 0.6), "the box is neither shot away nor pressed into the floor"),
            above(0.0, "right", "left"),
        ),
        expects={"carried": (Carried("box", ("right", "left"), CLOSED[1] + 0.1, LET_GO[0]),)},
    )


SCENARIOS = (
    lifted(
        "palm", "A flat hand lifts a box and carries it away.", "That the box comes along and does not slip.",
        0.4, 0.6, carrying, 300, 140,
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
        "How far the hand sags under the load; that the box does not slip.", HELD_MASS, 0.5,
        lambda time: ((0.0, 0.0, LOW + (HIGH - LOW) * eased(time, 0.1, 0.8)),), 600, 110,
        (
            Bound("sag_error_max", 1e-5, "equation 6 at rest: K times the lag is the load, to a hundredth of a millimetre"),
            Bound("height_missing", 1e-4, "the box stays on the hand"),
            Bound("grip_slip_max", 1e-4, "a box on a hand that holds still lies still"),
        ),
        Region(("box", "hand"), (-0.1, -0.1, 0.2), (0.1, 0.1, 0.6), "the box lies on the hand, and the hand is below its user"),
        {"sags": (Sag("hand", 9.81 * HELD_MASS / CouplingSettings().spring, STILL),),
         "carried": (Carried("box", ("hand",), STILL),)},
    ),
    pinched("pinch_light", 0.3, 0.01),
    pinched("pinch_heavy", 1.0, 0.02),
    led_hands(
        "press_coin", "A palm presses a coin on a table.", "That the coin stays where it is.",
        lambda: (slab(2.0, 2.0, "wood", "table"), loose("coin", COIN, "coin", COIN_MASS, (*AT, 0.5 * COIN_THICK + LAID))),
        lambda: (driven("hand", Box(PALM), 0.5, "hand"),),
        lambda time: ((0.0, 0.0, COIN_THICK + 0.5 * PALM[2] + OVER - (OVER + DEEP) * eased(time, 0.1, 0.9)),),
        one_law(0.0, 0.5, ("wood", "coin"), ("coin", "hand")), frames=1800, short=120,
        bounds=(
            *SOUND, replace(KEEPS_MOVING, limit=15.0, reason="while its user goes on into the coin the palm has nowhere to go"),
            Bound("pressed_sideways_max", 1e-5, "pressed straight down within friction's cone nothing slides"),
        ),
        regions=(
            Region(("coin", "hand"), (-0.1, -0.1, 0.0), (0.1, 0.1, 0.2), "the coin is neither shot away nor pressed down"),
        ),
        expects={"pressed": (Pressed("coin", 1.0),)},
    ),
)
