"""Ten boxes stand on one another: they come to rest, and then nothing moves any more. `rest_ten_minutes`: for ten minutes.

They begin with a millimetre of air between them, so that an engine that does nothing at all is not at rest but in the air.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import pair_table
from scenarios.building.expected import Rest
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

EDGE, MASS, AIR = 0.2, 1.0, 1e-3
"""Edge [m] and mass [kg] of a box, air below each at the start [m]."""
BOXES = tuple(f"box_{k}" for k in range(10))
RESTS = 0.5
"""From then on [s] all lie still: the topmost has fallen 1 cm, which takes 0.05 s."""

SLEEPS = 300
"""Frames of a quick comparison: Bullet puts to sleep what has rested for 2 s, and to show in a median that has to be more than
half of the frames. With 60 it never slept."""


def stack() -> tuple[Body, ...]:
    """The floor, its top at z = 0, and the ten boxes."""
    pieces = (Piece(Box((EDGE, EDGE, EDGE))),)
    bodies: list[Body] = [fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    for k, name in enumerate(BOXES):
        bodies.append(simulated(name, pieces, "box", solid(pieces, MASS), (0.0, 0.0, (k + 0.5) * EDGE + (k + 1) * AIR)))
    return tuple(bodies)


def build() -> Scene:
    """The stack alone, of a wood that does not bounce."""
    dull = ContactLaw(0.0, 0.5)
    materials = pair_table(("floor", "box"), {("floor", "box"): dull, ("box", "box"): dull})
    return Scene("stack_ten", stack(), materials=materials)


def ten_minutes() -> Scene:
    """The stack, and one box by itself two stacks' widths away."""
    pieces = (Piece(Box((EDGE, EDGE, EDGE))),)
    alone = simulated("alone", pieces, "box", solid(pieces, MASS), (1.0, 0.0, 0.5 * EDGE + AIR))
    dull = ContactLaw(0.0, 0.5)
    materials = pair_table(("floor", "box"), {("floor", "box"): dull, ("box", "box"): dull})
    return Scene("rest_ten_minutes", (*stack(), alone), materials=materials)


BOUNDS = (
    NO_OVERLAP, RIGHT_SIDE, FINITE,
    Bound("drift_max", 1e-6, "what rests stays where it is"),
    Bound("rest_energy_end", 1e-12, "what rests does not move"),
    Bound("travel_missing", 0.0, "every box comes down on the one below"),
    Bound("halted_frames", 0.0, "no box hangs in the air"),
)
ABOVE = "no box falls through the floor or off the stack"
FALLS = {name: 0.9 * (k + 1) * AIR for k, name in enumerate(BOXES)}

SCENARIOS = (
    Scenario(
        name="stack_ten",
        title="Ten boxes settle on one another and rest.",
        judged="Overlap, drift and motion left.",
        build=build,
        motion=untracked(),
        frames=600,
        short=SLEEPS,
        bounds=BOUNDS,
        regions=(Region(("box_*",), (-0.1, -0.1, 0.0), (0.1, 0.1, INFINITE), ABOVE),),
        expects={"rests": (Rest(BOXES, RESTS),), "travel": FALLS},
    ),
    Scenario(
        name="rest_ten_minutes",
        title="A box, and a stack of ten, rest for ten minutes.",
        judged="Overlap, drift and motion left.",
        build=ten_minutes,
        motion=untracked(),
        frames=36_000,
        short=SLEEPS,
        bounds=BOUNDS,
        regions=(Region(("box_*",), (-0.1, -0.1, 0.0), (0.1, 0.1, INFINITE), ABOVE),),
        expects={"rests": (Rest((*BOXES, "alone"), RESTS),), "travel": {**FALLS, "alone": 0.9 * AIR}},
    ),
)
