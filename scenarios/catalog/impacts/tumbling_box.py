"""Boxes are thrown on the floor spinning, with restitution 0 to 0.9 and friction 0 to 1: no frame may gain energy.

Each box is judged by itself, so that none can hide its gain behind another's loss.
"""

from collections.abc import Iterator

from avatarsim.scene.body import Body
from avatarsim.scene.shape import Box
from scenarios.building.cases import laws, loose, slab, turned_by
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

BOXES = {f"box_{e:g}_{mu:g}": (e, mu) for e in (0.0, 0.3, 0.6, 0.9) for mu in (0.0, 0.3, 0.6, 1.0)}
"""Restitution and friction of each."""


def bodies() -> Iterator[Body]:
    """Sixteen boxes over one floor, five metres apart, every one turned and spinning in a way of its own."""
    yield slab(40.0, 40.0)
    for k, name in enumerate(BOXES):
        at = (5.0 * (k % 4 - 1.5), 5.0 * (k // 4 - 1.5), 0.6)
        turn, spin = turned_by((0.6, 0.0, 0.8), 0.3 + 0.35 * k), (4.0 - 0.5 * k, 3.0, -2.0 + 0.3 * k)
        yield loose(name, Box((0.2, 0.3, 0.4)), name, 2.0, at, turn, (1.0, 0.5, 0.0), spin)


SCENARIO = undriven(
    "tumbling_box", "Sixteen boxes tumble over the floor, with restitution 0 to 0.9 and friction 0 to 1.",
    "Energy of every box in every frame.", bodies, laws({(name, "floor"): law for name, law in BOXES.items()}),
    frames=240, short=90,
    bounds=(
        *SOUND, NO_ENERGY, Bound("travel_missing", 0.0, "all come down"), Bound("halted_frames", 0.0, "no box hangs in the air"),
    ),
    regions=(above(0.0, "box_*"),), expects={"alone": each_alone(BOXES), "travel": dict.fromkeys(BOXES, 0.2)},
)
