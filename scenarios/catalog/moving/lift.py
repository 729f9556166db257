"""A lift brings a box up half a metre and stands: equation 6 with its stiffness lets it sag by m g / K."""

from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.spatial import rotation
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Carried
from scenarios.building.promises import FINITE, KEEPS_MOVING, KEEPS_TIME, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.moving_bodies import given
from scenarios.motion.rigid_hands import eased
from scenarios.scenario import Bound, Region, Scenario

MASS, STIFFNESS = 5.0, 1e6
"""Mass of the box [kg], and stiffness of the lift [N/m]."""
LOW, RISE, RISES = 0.06, 0.5, (0.3, 1.3)
"""Height of the lift's middle before it rises [m], how far it does [m], and when [s]."""
PLATE, CUBE = (1.0, 1.0, 0.08), (0.2, 0.2, 0.2)
SAG = 9.81 * MASS / STIFFNESS


def build() -> Scene:
    """Return a floor, the lift above it, and the box on the lift."""
    plate, cube = (Piece(Box(PLATE)),), (Piece(Box(CUBE)),)
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    top = LOW + 0.5 * PLATE[2]
    box = simulated("box", cube, "box", solid(cube, MASS), (0.0, 0.0, top + 0.5 * CUBE[2] + LAID))
    lift = moving("lift", plate, "wood", position=(0.0, 0.0, LOW), stiffness=STIFFNESS)
    return Scene("lift", (floor, box), (lift,), pair_table(("wood", "box"), {("wood", "box"): ContactLaw(0.0, 0.5)}))


SCENARIO = Scenario(
    name="lift",
    title="A lift brings up a box.",
    judged="That the box comes along and does not slip; how far the lift is below where it should be.",
    build=build,
    motion=given(lambda time: {"lift": ((0.0, 0.0, LOW + RISE * eased(time, *RISES)), rotation.IDENTITY)}),
    frames=300,
    short=110,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, KEEPS_MOVING, KEEPS_TIME,
        Bound("height_missing", 2.0 * SAG, "the box comes up with the lift, which its weight lowers by K"),
        Bound("grip_slip_max", 1e-4, "what stands on a lift stands still on it"),
    ),
    regions=(Region(("box",), (-0.1, -0.1, 0.1), (0.1, 0.1, 0.8), "the box stays on the lift"),),
    expects={"carried": (Carried("box", ("lift",), 0.2),)},
)
