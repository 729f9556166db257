"""Mass ratios in stacks: a heavy box on a light one, up to the largest ratio that an engine can stack.

`heavy_on_light` is the tower of a thousand to one; `heavy_on_light_ratios` asks for the largest ratio that stands, from equal
masses to ten thousand to one. Each tower begins with a millimetre of air below either box. One that stands has its boxes where
they touch.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import pair_table
from scenarios.building.expected import Course, Rest, Tower, steady
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

Ratios = tuple[float, ...]
SOUGHT: Ratios = (1e3,)
LADDER: Ratios = (1.0, 10.0, 100.0, 1e3, 1e4)
"""Mass of the upper box over that of the lower, which is 1 kg, tower by tower."""
EDGE, AIR = 0.2, 1e-3
"""Edge of a box, air below each at the start [m]."""
RESTS = 0.4
"""From then on [s] all lie still."""
LANE = 1.0
"""Distance of the towers [m]."""


def build(name: str, ratios: Ratios) -> Scene:
    """Towers of two boxes on one floor."""
    pieces = (Piece(Box((EDGE, EDGE, EDGE))),)
    bodies: list[Body] = [fixed("floor", (Piece(Box((8.0, 4.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    for k, ratio in enumerate(ratios):
        x = LANE * (k - 2)
        bodies.append(simulated(f"light_{ratio:g}", pieces, "box", solid(pieces, 1.0), (x, 0.0, 0.5 * EDGE + AIR)))
        bodies.append(simulated(f"heavy_{ratio:g}", pieces, "box", solid(pieces, ratio), (x, 0.0, 1.5 * EDGE + 2.0 * AIR)))
    dull = ContactLaw(0.0, 0.5)
    materials = pair_table(("floor", "box"), {("floor", "box"): dull, ("box", "box"): dull})
    return Scene(name, tuple(bodies), materials=materials)


def courses(ratios: Ratios) -> tuple[Course, ...]:
    """Where boxes stand that touch."""
    found = []
    for k, ratio in enumerate(ratios):
        found.append(Course(f"light_{ratio:g}", steady(LANE * (k - 2), 0.0, 0.5 * EDGE), since=RESTS))
        found.append(Course(f"heavy_{ratio:g}", steady(LANE * (k - 2), 0.0, 1.5 * EDGE), since=RESTS))
    return tuple(found)


def of_towers(name: str, ratios: Ratios, title: str, shifted: Bound) -> Scenario:
    """The scene with these towers, and by how much a landing may shift a box."""
    boxes = tuple(box for ratio in ratios for box in (f"light_{ratio:g}", f"heavy_{ratio:g}"))
    return Scenario(
        name=name,
        title=title,
        judged="Whether each tower stands, and how far into each other.",
        build=lambda: build(name, ratios),
        motion=untracked(),
        frames=600,
        short=60,
        bounds=(
            NO_OVERLAP, RIGHT_SIDE, FINITE, shifted,
            Bound("towers_fallen", 0.0, "a thousand to one is what is sought, and ten thousand to one can be had"),
            Bound("drift_max", 1e-6, "what rests stays where it is"),
            Bound("rest_energy_end", 1e-12, "what rests does not move"),
        ),
        regions=(Region(("light_*", "heavy_*"), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no box falls through the floor"),),
        expects={
            "courses": courses(ratios), "rests": (Rest(boxes, RESTS),),
            "towers": tuple(Tower(f"heavy_{r:g}", r, (LANE * (k - 2), 0.0, 1.5 * EDGE), RESTS) for k, r in enumerate(ratios)),
        },
    )


SCENARIOS = (
    of_towers(
        "heavy_on_light", SOUGHT, "A heavy box on a light one, a thousand to one.",
        Bound("course_error_max", 1e-5, "boxes that stand are where they touch, to what a landing may shift them"),
    ),
    of_towers(
        "heavy_on_light_ratios", LADDER, "Heavy boxes on light ones: 1, 10, 100, 1000 and 10,000 to one.",
        Bound("course_error_max", 1e-4, "impulses one after the other turn a heavy box as it lands: it slides by 20 micrometres"),
    ),
)
