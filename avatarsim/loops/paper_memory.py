"""State and counters of the lower loop of method `paper`, allocated once; the kernels allocate nothing."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.scratch import PIECES_CAP
from avatarsim.jit.layout import FlagLine, IndexLine, Line, Vectors
from avatarsim.paper.chain import Chains, chains_of
from avatarsim.separate.overlaps import Overlaps, make_overlaps
from avatarsim.spatial.random import seeded
from avatarsim.world.skeleton import Posture
from avatarsim.world.world import World

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

COUNT_NAMES: Final = (
    "joints", "iterations", "pairs", "queries", "sweeps", "rounds", "forwards", "pushes", "parallel_links", "bent_chains",
    "walk_back_tests",
)
"""Per frame: unit joints solved by CCD, goals given to CCD, overlapping pairs of bodies, signed-distance queries (Table 2's
columns; joints and pairs summed over the goals and rounds, as its figures suggest), then sweeps of CCD, rounds over all chains,
runs of the kinematics, PD_g pushes, nearly parallel links, straight chains that had to be bent, states tried in walking back."""

STATUS_NAMES: Final = (
    "cancelling_normals", "goal_not_reached", "out_of_rounds", "walked_back", "held", "start_overlaps", "not_checked",
    "bad_queries", "gave_way",
)
"""How often per frame: eq. 1 had no direction; CCD ended away from its goal; overlap was left after the last round; the walk
back was needed; it ended at the last checked state; even that one overlaps (something else moved into it, or the frame did not
begin free); a state could not be checked (a pose that is no number); a distance query did not converge; a simulated
body was pushed because the driven one could not part from it."""

(
    JOINTS, ITERATIONS, PAIRS, QUERIES, SWEEPS, ROUNDS, FORWARDS, PUSHES, PARALLEL, BENT, WALK_TESTS,
    CANCELLED, NOT_REACHED, OUT_OF_ROUNDS, WALKED_BACK, HELD, START_OVERLAPS, UNCHECKED, BAD,
    GAVE_WAY,
) = range(len(COUNT_NAMES) + len(STATUS_NAMES))


class PaperMemory(NamedTuple):
    """Memory of `paper_rounds.follow_as_printed` for nl links with nd degrees of freedom among nb bodies.

    chains, overlaps   of posture and separate
    order, random      order of the chains in this frame; state (1) of its generator
    role, mass         (nb) fixed, simulated or driven; (nl) m of eq. 6 [kg]
    target             the posture that joints are drawn to, roots where eq. 6 puts them
    checked, present   the last shown posture; the one that is walked back from
    start, end         (nb, 3) positions of bodies at the frame's begin and before the walk back [m]
    given_way          (nb) simulated bodies that had to move in this frame
    tracked, velocity  (nl, 3) the tracker's roots at the last frame [m]; velocity of the shown roots [m/s]
    axes, none         (nd, 3) world axes of the joints; (nd) no step
    points             contacts of a link
    chosen             (nl) links that are walked back
    counts             by COUNT_NAMES, then STATUS_NAMES
    """

    chains: Chains
    overlaps: Overlaps
    order: IndexLine
    random: IndexLine
    role: IndexLine
    mass: Line
    target: Posture
    checked: Posture
    present: Posture
    start: Vectors
    end: Vectors
    given_way: FlagLine
    tracked: Vectors
    velocity: Vectors
    axes: Vectors
    none: Line
    points: Vectors
    chosen: FlagLine
    counts: IndexLine

WORKING: Final = (
    "memory.chains", "memory.role", "memory.mass", "memory.counts", "memory.points", "memory.none", "memory.overlaps.ours.first",
    "memory.overlaps.ours.never", "memory.overlaps.sweep", "memory.overlaps.pairs", "memory.overlaps.found",
    "memory.overlaps.tally",
)
"""What a snapshot leaves out: what never changes, and what each frame fills before it reads it."""


def make_paper_memory(world: World, seed: int) -> PaperMemory:
    """Fresh memory for a world that stands at a free pose; ``seed`` settles the order of the chains for good."""
    geo, skel = world.geometry, world.skeleton
    nl, nd, nb = len(skel.kind), int(skel.first_dof[-1]), len(geo.first_shape) - 1
    chains = chains_of(world.scene.avatars, geo, skel)

    def like(posture: Posture) -> Posture:
        return Posture(*(array.copy() for array in posture))

    return PaperMemory(
        chains, make_overlaps(geo, skel.first), np.arange(len(chains.first) - 1, dtype=np.int64), seeded(seed),
        world.dynamics.role.copy(), 1.0 / world.dynamics.inverse_mass[skel.first :],
        like(world.posture), like(world.posture), like(world.posture), np.zeros((nb, 3)), np.zeros((nb, 3)),
        np.zeros(nb, dtype=np.bool_), world.posture.root.copy(), np.zeros((nl, 3)), np.zeros((nd, 3)), np.zeros(nd),
        np.zeros((PIECES_CAP, 3)), np.zeros(nl, dtype=np.bool_),
        np.zeros(len(COUNT_NAMES) + len(STATUS_NAMES), dtype=np.int64),
    )
