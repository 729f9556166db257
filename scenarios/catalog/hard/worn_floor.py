"""A floor that is not quite even: boxes slide down a stair whose steps are a micrometre high, and hardly go farther.

Each step adds m g times a micrometre to what friction has to take: eleven of them, three hundredths of a thousandth of the way.
Corners that stand on different steps ask a rigid body for velocities that it cannot have at once, and a solver that takes its
time, or jumps, goes centimetres too far. No step leads up: that would be a wall.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from reference.closed_form import stop_distance, stop_time
from scenarios.building.cases import LAID, pair_table, turned_by
from scenarios.building.expected import Stop
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

LONG, WIDE, THICK, LANE = 5.0, 0.8, 0.2, 1.0
"""Edges of every floor [m], and the distance of neighbouring floors [m]."""
STONES, STEP = 64, 1e-6
"""Stones along a floor, and how much lower each is than the last [m]: what wear and laying leave of a floor that looks even."""
START, EVEN = -1.5, -1.2
"""Where the boxes begin along x, and up to where all stones are level [m]."""
SPEED, FRICTION, GRAVITY, MASS, SIZE = 2.0, 0.5, 9.81, 1.0, (0.3, 0.3, 0.1)
"""First speed [m/s], friction, gravity [m/s^2], mass [kg] and edges [m] of the boxes."""
TURNS = {"straight": 0.0, "turned": 0.5}
"""How the boxes are turned about the vertical [rad]: with a whole edge over each seam, or corner after corner."""
FLOORS = ("one", "many")
"""A floor of one body, and one whose stones are bodies of their own."""
RATE = 240
"""Frames per second. At 60 the end of the last slip is found to a fifth of a millimetre only."""


def stones() -> list[Piece]:
    """Boxes side by side along x, each but the first ones a step lower than the one before."""
    long, found, down = LONG / STONES, [], 0
    for k in range(STONES):
        x = (k + 0.5) * long - 0.5 * LONG
        down += 1 if x > EVEN else 0
        found.append(Piece(Box((long, WIDE, THICK)), (x, 0.0, -0.5 * THICK - STEP * down)))
    return found


def floor(kind: str, y: float) -> list[Body]:
    """The stones as one fixed body, or each as one."""
    if kind == "one":
        return [fixed(f"one_{y:g}", tuple(stones()), "stone", (0.0, y, 0.0))]
    return [fixed(f"many_{y:g}_{k}", (stone,), "stone", (0.0, y, 0.0)) for k, stone in enumerate(stones())]


CASES = {f"{turn}_on_{kind}": (turn, kind) for kind in FLOORS for turn in TURNS}


def build() -> Scene:
    """Four floors beside one another, a box on each."""
    pieces, bodies = (Piece(Box(SIZE)),), list[Body]()
    for lane, (name, (turn, kind)) in enumerate(CASES.items()):
        y = LANE * (lane - 1.5)
        bodies += floor(kind, y)
        turned = turned_by((0.0, 0.0, 1.0), TURNS[turn])
        bodies.append(simulated(
            name, pieces, "box", solid(pieces, MASS), (START, y, 0.5 * SIZE[2] + LAID), turned, (SPEED, 0.0, 0.0)
        ))
    return Scene("worn_floor", tuple(bodies), materials=pair_table(
        ("stone", "box"), {("stone", "box"): ContactLaw(0.0, FRICTION)}
    ))


SCENARIO = Scenario(
    name="worn_floor",
    title="Boxes slide over floors whose stones are a micrometre lower one after another.",
    judged="How far, and how straight.",
    build=build,
    motion=untracked(1.0 / RATE),
    frames=RATE // 2,
    dt=1.0 / RATE,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("stop_distance_error_max", 0.01, "v^2 / (2 mu g) to a ten-thousandth; the steps are a quarter of that"),
        Bound("stop_direction_error_max", 0.01, "no step is higher on one side than on the other"),
        Bound("energy_gain_max", 1e-9, "a step gives what the box was higher, and no more"),
    ),
    regions=(Region(tuple(CASES), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "nothing falls between the stones"),),
    expects={
        "stops": tuple(
            Stop(name, stop_distance(SPEED, FRICTION, GRAVITY), (1.0, 0.0, 0.0), stop_time(SPEED, FRICTION, GRAVITY))
            for name in CASES
        ),
        "alone": tuple((name,) for name in CASES),
    },
)
