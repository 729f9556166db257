"""Boxes are thrown on the floor spinning, with restitution 0 to 0.9 and friction 0 to 1: no frame may gain energy.

Newton's restitution with friction can add energy at an eccentric impact; constant forces on a turning arm can too. Each box is
judged by itself, so that none can hide its gain behind another's loss.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import pair_table, turned_by
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

RESTITUTIONS = (0.0, 0.3, 0.6, 0.9)
FRICTIONS = (0.0, 0.3, 0.6, 1.0)
SIZE, MASS, HEIGHT = (0.2, 0.3, 0.4), 2.0, 0.6
"""Edges [m], mass [kg], height of the middle at the start [m]."""
CASES = tuple((e, mu) for e in RESTITUTIONS for mu in FRICTIONS)
BOXES = tuple(f"box_{e:g}_{mu:g}" for e, mu in CASES)


def build() -> Scene:
    """Sixteen boxes over one floor, three metres apart, every one turned and spinning in a way of its own."""
    bodies: list[Body] = [fixed("floor", (Piece(Box((40.0, 40.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    pieces = (Piece(Box(SIZE)),)
    stated = {}
    for k, (name, (e, mu)) in enumerate(zip(BOXES, CASES, strict=True)):
        at = (5.0 * (k % 4 - 1.5), 5.0 * (k // 4 - 1.5), HEIGHT)
        turn = turned_by((0.6, 0.0, 0.8), 0.3 + 0.35 * k)
        spin = (4.0 - 0.5 * k, 3.0, -2.0 + 0.3 * k)
        bodies.append(simulated(name, pieces, name, solid(pieces, MASS), at, turn, (1.0, 0.5, 0.0), spin))
        stated[name, "floor"] = ContactLaw(e, mu)
    return Scene("tumbling_box", tuple(bodies), materials=pair_table(("floor", *BOXES), stated))


SCENARIO = Scenario(
    name="tumbling_box",
    title="Sixteen boxes tumble over the floor, with restitution 0 to 0.9 and friction 0 to 1.",
    judged="Energy of every box in every frame.",
    build=build,
    motion=untracked(),
    frames=240,
    short=90,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("energy_gain_max", 1e-9, "the law of impact takes energy, and nothing else acts but gravity"),
        Bound("travel_missing", 0.0, "all come down"),
        Bound("halted_frames", 0.0, "no box hangs in the air"),
    ),
    regions=(Region(("box_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no box falls through the floor"),),
    expects={"alone": tuple((box,) for box in BOXES), "travel": dict.fromkeys(BOXES, 0.2)},
)
