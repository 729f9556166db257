"""State and counters of the lower loop of method `paper`, allocated once; the kernels allocate nothing.

Kinematic chains of all avatars, from the trunk to the tips, and their seeded random order (Fisher-Yates shuffle).
"""

from collections.abc import Sequence
from typing import Annotated, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.scratch import PIECES_CAP
from avatarsim.jit.kept import NOT_KEPT, Whole
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import FlagLine, IndexLine, Line, Vectors
from avatarsim.model.geometry import ELLIPSOID, Geometry
from avatarsim.model.skeleton import FREE, Posture, Skeleton
from avatarsim.model.world import World
from avatarsim.paper.push_apart import Overlaps, make_overlaps
from avatarsim.scene.avatar import Avatar
from avatarsim.spatial.random import MODULUS, draw, seeded

Array = NDArray[np.float64]
Index = NDArray[np.int64]

class Chains(NamedTuple):
    """nc chains of links, and the data that the lower loop needs of each of the nl links.

    first   (nc + 1) chain c has the links link[first[c]] .. link[first[c + 1] - 1], the one next to the trunk first
    link    link indices
    trunk   (nl) True: a free root, or a link shared by several chains above a free root; moved by translation, never by CCD
    root    (nl) the root of the link's avatar
    limb    (nl, 3) from the joint to where the limb ends, in the link's frame [m]; zero if it has no direction
    """

    first: IndexLine
    link: IndexLine
    trunk: FlagLine
    root: IndexLine
    limb: Vectors


def chains_of(avatars: Sequence[Avatar], geo: Geometry, skel: Skeleton) -> Chains:
    """Return chains named by the avatars, or from every leaf if none is named; links on no named chain get their own."""
    nl = len(skel.kind)
    root = np.arange(nl, dtype=np.int64)
    for link in range(nl):
        if skel.parent[link] >= 0:
            root[link] = root[skel.parent[link]]
    leaf = ~np.isin(np.arange(nl), skel.parent)
    trunk = skel.kind == FREE
    found: list[list[int]] = []
    start = 0
    for avatar in avatars:
        at = {link.name: start + k for k, link in enumerate(avatar.links)}
        start += len(at)
        leaves = [link for link in at.values() if leaf[link]]
        paths = [_path(skel, tip) for tip in ([at[name] for name in avatar.chains] or leaves)]
        if skel.kind[root[leaves[0]]] == FREE:
            for link in at.values():
                trunk[link] |= sum(link in path for path in paths) > 1
        covered = {link for path in paths for link in path}
        for tip in leaves:
            own = [link for link in _path(skel, tip) if link not in covered]
            covered.update(own)
            paths.append(own)
        found += [[link for link in path if not trunk[link]] for path in paths]
    found = [chain for chain in found if chain]
    flat = np.array([link for chain in found for link in chain], dtype=np.int64)
    return Chains(np.cumsum([0, *(len(chain) for chain in found)]).astype(np.int64), flat, trunk, root, _limbs(found, geo, skel))


def _path(skel: Skeleton, tip: int) -> list[int]:
    """Return links from the root to ``tip``."""
    path = [tip]
    while skel.parent[path[-1]] >= 0:
        path.append(int(skel.parent[path[-1]]))
    return path[::-1]


def _limbs(chains: list[list[int]], geo: Geometry, skel: Skeleton) -> Array:
    """Return limbs: each to the next joint of its chain; at a tip to the far side of its shapes, twice as far as their middle."""
    limb = np.zeros((len(skel.kind), 3))
    for chain in chains:
        for link, following in zip(chain, [*chain[1:], -1], strict=True):
            if following >= 0 and skel.parent[following] == link and np.any(skel.anchor[following]):
                limb[link] = skel.anchor[following]
            else:
                pieces = range(geo.first_shape[skel.first + link], geo.first_shape[skel.first + link + 1])
                middles = [_middle(geo, piece) for piece in pieces]
                limb[link] = 2.0 * np.mean(middles, axis=0) if middles else 0.0
    return limb


def _middle(geo: Geometry, piece: int) -> Array:
    rows = geo.local[geo.shapes.start[piece] : geo.shapes.start[piece + 1]]
    middle: Array = rows[0] if geo.shapes.kind[piece] == ELLIPSOID else rows.mean(axis=0)
    return middle


@kernel
def shuffle(state_out: Index, order_out: Index) -> None:
    """Write a fresh random order of 0 .. n - 1 (Fisher and Yates)."""
    n = order_out.shape[0]
    for k in range(n):
        order_out[k] = k
    for k in range(n - 1, 0, -1):
        other = draw(state_out, k + 1)
        kept = order_out[k]
        order_out[k] = order_out[other]
        order_out[other] = kept


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
"""Counts per frame: eq. 1 had no direction; CCD ended away from its goal; overlap was left after the last round; the walk back
was needed; it ended at the last checked state; even that one overlaps (something else moved into it, or the frame did not begin
free); a state could not be checked (a pose that is no number); a distance query did not converge; a simulated body was pushed
because the driven one could not part from it."""

(
    JOINTS, ITERATIONS, PAIRS, QUERIES, SWEEPS, ROUNDS, FORWARDS, PUSHES, PARALLEL, BENT, WALK_TESTS,
    CANCELLED, NOT_REACHED, OUT_OF_ROUNDS, WALKED_BACK, HELD, START_OVERLAPS, UNCHECKED, BAD,
    GAVE_WAY,
) = range(len(COUNT_NAMES) + len(STATUS_NAMES))


class PaperMemory(NamedTuple):
    """Memory of `algorithm_1.follow_as_printed` for nl links with nd degrees of freedom among nb bodies.

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

    chains: Annotated[Chains, NOT_KEPT]
    overlaps: Overlaps
    order: Annotated[IndexLine, Whole(0, lambda sizes: sizes.rows - 1)]
    random: Annotated[IndexLine, Whole(1, MODULUS - 1)]
    role: Annotated[IndexLine, NOT_KEPT]
    mass: Annotated[Line, NOT_KEPT]
    target: Posture
    checked: Posture
    present: Posture
    start: Vectors
    end: Vectors
    given_way: FlagLine
    tracked: Vectors
    velocity: Vectors
    axes: Vectors
    none: Annotated[Line, NOT_KEPT]
    points: Annotated[Vectors, NOT_KEPT]
    chosen: FlagLine
    counts: Annotated[IndexLine, NOT_KEPT]


def make_paper_memory(world: World, seed: int) -> PaperMemory:
    """Return fresh memory for a world at a free pose; ``seed`` settles the order of the chains for good."""
    geo, skel = world.geometry, world.skeleton
    nl, nd, nb = len(skel.kind), int(skel.first_dof[-1]), len(geo.first_shape) - 1
    chains = chains_of(world.scene.avatars, geo, skel)

    def like(posture: Posture) -> Posture:
        return Posture(*(array.copy() for array in posture))

    return PaperMemory(
        chains, make_overlaps(geo, skel.first), np.arange(len(chains.first) - 1, dtype=np.int64), seeded(seed),
        world.dynamics.role.copy(), world.drive.mass[skel.first :],
        like(world.posture), like(world.posture), like(world.posture), np.zeros((nb, 3)), np.zeros((nb, 3)),
        np.zeros(nb, dtype=np.bool_), world.posture.root.copy(), np.zeros((nl, 3)), np.zeros((nd, 3)), np.zeros(nd),
        np.zeros((PIECES_CAP, 3)), np.zeros(nl, dtype=np.bool_),
        np.zeros(len(COUNT_NAMES) + len(STATUS_NAMES), dtype=np.int64),
    )
