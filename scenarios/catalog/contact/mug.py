"""A mug is lifted, carried aside and tilted: by three hinged fingers that set it down again, and attached to a fist.

The fingers' user closes them 1.5 cm into the mug, which is a prism without a handle; friction alone holds it. The fist's user
presses the mug 3 cm into the floor: the fist stays above it.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings
from avatarsim.spatial import rotation
from scenarios.building.cases import LAID, driven, loose, one_law, slab
from scenarios.building.expected import Carried
from scenarios.building.promises import KEEPS_MOVING, NO_LEAP, NO_LEAP_OF_THE_ROOT, SOUND, WITHIN_LIMITS
from scenarios.building.things import prism
from scenarios.motion.rigid_hands import by_time, eased
from scenarios.scenario import Bound, Region, Scenario

HEIGHT, MASS = 0.09, 0.35
"""Height [m] and mass [kg] of the mug."""
SAG = 9.81 * MASS / CouplingSettings().spring
"""Sag of a mug below its user [m]: m g / K."""
ANSWERS = replace(KEEPS_MOVING, limit=5.0)

PALM, BOTTOM = (0.07, 0.02), 0.125
"""Radius and thickness of the palm, and how high its face begins above the floor [m]."""
FINGER, KNUCKLE, FINGERS = (0.009, 0.08), 0.062, tuple(f"finger_{k}" for k in range(3))
"""Radius and length of a finger, and how far from the palm's middle its hinge is [m]."""
OPEN, CLOSED, LIMIT = 0.25, -0.35, 0.6
"""Angles of the fingers' user, outward, and the hinges' limits to both sides [rad]: a finger meets the mug at -0.19."""
CLOSES, RISES, ASIDE, TILTS, UPRIGHT, SINKS, OPENS = (
    (0.1, 0.7), (0.9, 1.7), (2.2, 3.2), (3.3, 3.8), (3.8, 4.3), (4.5, 5.3), (5.5, 5.9),
)
"""Times [s] of the actions of the fingers' user."""
RISE, CARRY, TILT = 0.15, 0.3, 0.5
"""Ways up and aside [m], and tilt of the mug [rad]."""

FIST, BESIDE = 0.045, 0.082
"""Radius of the fist, and its distance from the axis of the mug [m]."""
FIST_RISE, FIST_TILT, INTO, LOWERS = 0.2, 0.6, 0.03, 3.3
"""Height of the lift [m], tilt [rad], depth below the floor to which the user lowers the mug [m], and from when on [s]."""


def fingers() -> Avatar:
    """Return a round palm whose three fingers hang from its rim; positive angles open them."""
    palm = (prism(24, PALM[0], PALM[1]),)
    finger = (Piece(Capsule(*FINGER), (0.0, 0.0, -0.5 * FINGER[1] - FINGER[0] - 0.001)),)
    links = [Link("palm", None, Free(), palm, solid(palm, 0.5), "hand")]
    for k, name in enumerate(FINGERS):
        angle = 2.0 * math.pi * k / len(FINGERS)
        x, y = math.cos(angle), math.sin(angle)
        hinge = Hinges((Hinge((y, -x, 0.0), -LIMIT, LIMIT),))
        anchor = (KNUCKLE * x, KNUCKLE * y, -0.5 * PALM[1] - 0.002)
        links.append(Link(name, "palm", hinge, finger, solid(finger, 0.08), "hand", anchor))
    return Avatar("hand", tuple(links), chains=FINGERS)


def in_fingers(time: float) -> TrackerSample:
    """Return the fingers' user at a time [s]."""
    height = BOTTOM + 0.5 * PALM[1] + RISE * (eased(time, *RISES) - eased(time, *SINKS))
    place = (CARRY * eased(time, *ASIDE), 0.0, height)
    turn = rotation.from_axis_angle((0.0, 1.0, 0.0), TILT * (eased(time, *TILTS) - eased(time, *UPRIGHT)))
    bend = OPEN + (CLOSED - OPEN) * (eased(time, *CLOSES) - eased(time, *OPENS))
    return TrackerSample(
        time, np.vstack([place, np.zeros((3, 3))]), np.vstack([turn, np.tile(rotation.IDENTITY, (3, 1))]), np.full(3, bend)
    )


def at_fist(time: float) -> TrackerSample:
    """Return the fist's user at a time [s]."""
    lowered = (FIST_RISE + INTO) * (eased(time, 5.0, 5.6) - eased(time, LOWERS, 4.1))
    height = 0.5 * HEIGHT + LAID + FIST_RISE * eased(time, 0.2, 1.0) + lowered
    turn = rotation.from_axis_angle((0.0, 1.0, 0.0), FIST_TILT * (eased(time, 2.2, 2.7) - eased(time, 2.7, 3.2)))
    place = (CARRY * eased(time, 1.2, 2.2) - BESIDE, 0.0, height)
    return TrackerSample(time, np.array([place]), turn[None], np.zeros(0))


def lifted(
    name: str, title: str, judged: str, hand: Callable[[], Avatar], at: Callable[[float], TrackerSample], frames: int,
    short: int | None, bounds: tuple[Bound, ...], wide: float, carried: tuple[Carried, ...],
    attached: tuple[tuple[str, str], ...] = (),
) -> Scenario:
    """Return the mug on a floor, and a hand whose user is `at` given postures."""

    def build() -> Scene:
        mug = loose("mug", prism(24, 0.035, HEIGHT), "mug", MASS, (0.0, 0.0, 0.5 * HEIGHT + LAID))
        materials = one_law(0.0, 0.7, ("floor", "mug"), ("mug", "hand"))
        return Scene(name, (slab(4.0, 4.0), mug), (hand(),), materials, start=at(0.0), attached=attached)

    return Scenario(
        name, title, judged, build, by_time(at), frames, short, bounds=(*SOUND, *bounds),
        regions=(
            Region(("mug",), (-wide, -wide, 0.0), (0.6, wide, 0.4), "the mug is neither shot away nor pressed into the floor"),
        ),
        expects={"carried": carried},
    )


SCENARIOS = (
    lifted(
        "mug_in_fingers", "Three hinged fingers lift a mug, carry, tilt it and set it down.",
        "Overlap; limits; that the mug comes along and does not slip.", fingers, in_fingers, 372, 126,
        (
            WITHIN_LIMITS, NO_LEAP, NO_LEAP_OF_THE_ROOT, ANSWERS,
            Bound("height_missing", SAG + 1e-3, "the mug rises with its user, less the sag of one link; four links share it"),
            Bound("grip_slip_max", 1e-3, "fingers do not let the mug slip; as the palm tilts their springs yield a little"),
        ),
        0.3, (Carried("mug", ("hand/palm",), CLOSES[1] + 0.1, SINKS[0]),),
    ),
    lifted(
        "carried_mug", "A mug attached to a hand is carried, tilted and pressed onto the floor.",
        "Overlap; that the mug keeps its place on the hand, in the air and pressed onto the floor.",
        lambda: driven("hand", Sphere(FIST), 0.5, "hand"), at_fist, 345, None,
        (
            ANSWERS, NO_LEAP,
            # by equation 6 the hand also turns under the mug, by the squared ratio of lever and hand
            Bound("height_missing", 1.05 * (SAG * (1.0 + (BESIDE / FIST) ** 2)), "the mug rises with its user, less its sag"),
            Bound("grip_slip_max", 1e-6, "what is attached is one body with the hand"),
        ),
        0.2, (Carried("mug", ("hand",), 0.1, LOWERS), Carried("mug", ("hand",), LOWERS)), (("mug", "hand"),),
    ),
)
