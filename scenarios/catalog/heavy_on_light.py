"""Item 18: a heavy box on a light one, a thousand to one. How much can an engine stack?

Each tower begins with a millimetre of air below either box. A tower that stands has its boxes where they touch.
"""

from avatarsim.scene.body import Body, fixed, simulated
from avatarsim.scene.mass import solid
from avatarsim.scene.material import Contact
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.cases import pair_table
from scenarios.expected import Course, Rest, steady
from scenarios.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.scenario import INFINITE, Bound, Region, Scenario
from scenarios.untracked import untracked

RATIOS = (1e3,)
"""Mass of the upper box over that of the lower, which is 1 kg."""
EDGE, AIR = 0.2, 1e-3
"""Edge of a box, air below each at the start [m]."""
RESTS = 0.4
"""From then on [s] all lie still."""
LANE = 1.0
"""Distance of the towers [m]."""
BOXES = tuple(name for ratio in RATIOS for name in (f"light_{ratio:g}", f"heavy_{ratio:g}"))


def build() -> Scene:
    """Towers of two boxes on one floor."""
    pieces = (Piece(Box((EDGE, EDGE, EDGE))),)
    bodies: list[Body] = [fixed("floor", (Piece(Box((8.0, 4.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    for k, ratio in enumerate(RATIOS):
        x = LANE * (k - 2)
        bodies.append(simulated(f"light_{ratio:g}", pieces, "box", solid(pieces, 1.0), (x, 0.0, 0.5 * EDGE + AIR)))
        bodies.append(simulated(f"heavy_{ratio:g}", pieces, "box", solid(pieces, ratio), (x, 0.0, 1.5 * EDGE + 2.0 * AIR)))
    dull = Contact(0.0, 0.5)
    materials = pair_table(("floor", "box"), {("floor", "box"): dull, ("box", "box"): dull})
    return Scene("heavy_on_light", tuple(bodies), materials=materials)


def courses() -> tuple[Course, ...]:
    """Where boxes stand that touch."""
    found = []
    for k, ratio in enumerate(RATIOS):
        found.append(Course(f"light_{ratio:g}", steady(LANE * (k - 2), 0.0, 0.5 * EDGE), since=RESTS))
        found.append(Course(f"heavy_{ratio:g}", steady(LANE * (k - 2), 0.0, 1.5 * EDGE), since=RESTS))
    return tuple(found)


SCENARIO = Scenario(
    name="heavy_on_light",
    title="A heavy box on a light one, a thousand to one.",
    judged="Whether the tower stands, and how far into each other.",
    build=build,
    motion=untracked(),
    frames=600,
    short=60,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("course_error_max", 1e-5, "boxes that stand are where they touch, to what a landing may shift them"),
        Bound("drift_max", 1e-6, "what rests stays where it is"),
        Bound("rest_energy_end", 1e-12, "what rests does not move"),
    ),
    regions=(Region(("light_*", "heavy_*"), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no box falls through the floor"),),
    expects={"courses": courses(), "rests": (Rest(BOXES, RESTS),)},
)
