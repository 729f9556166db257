"""A stack of ten boxes is struck by a ball at 6 m/s and comes down.

The hard part is not to be exact but to go on: bodies in motion that touch one another keep their pace, whatever it costs.
"""

from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.cases import pair_table
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.catalog.stacks.stack_ten import BOXES, stack
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

RADIUS, MASS, SPEED = 0.1, 4.0, 6.0
"""Of the ball: [m], [kg], [m/s]."""
HEIGHT = 1.1
"""Where it strikes [m]: in the middle of the stack."""


def build() -> Scene:
    """The stack of `stack_ten` on a wide floor, and the ball 0.9 m before it."""
    ball, ground = (Piece(Sphere(RADIUS)),), (Piece(Box((40.0, 40.0, 0.2))),)
    lively = ContactLaw(0.3, 0.4)
    return Scene("stack_struck", (
        fixed("floor", ground, "floor", (0.0, 0.0, -0.1)), *stack()[1:],
        simulated("ball", ball, "box", solid(ball, MASS), (-1.1, 0.02, HEIGHT), velocity=(SPEED, 0.0, 0.0)),
    ), materials=pair_table(("floor", "box"), {("floor", "box"): lively, ("box", "box"): lively}))


SCENARIO = Scenario(
    name="stack_struck",
    title="A ball at 6 m/s strikes a stack of ten boxes, which comes down.",
    judged="Overlap, energy, and that nothing halts; the time of the worst frame.",
    build=build,
    motion=untracked(),
    frames=600,
    short=60,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("energy_gain_max", 1e-9, "impacts and friction take energy"),
        Bound("halted_frames", 0.0, "a budget that is spent ends in a plastic step and not in a halt"),
        Bound("travel_missing", 0.0, "the stack is struck: the box in the middle goes 0.3 m at least"),
    ),
    regions=(Region(("box_*", "ball"), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "nothing falls through the floor"),),
    expects={"alone": ((*BOXES, "ball"),), "travel": {"box_5": 0.3}},
)
