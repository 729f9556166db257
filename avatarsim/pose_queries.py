"""Queries of poses outside the frame: overlaps and joint limits of a first pose, and the contacts of the shown state.

The narrow phase is that of the frame (GJK, Gilbert et al. 1988, and EPA; faces clipped as by Sutherland and Hodgman, 1974), but
run without warm starts and outside the frame: a query changes no state, and a frame without one has no cost. A first pose is
checked over every pair that the scene's pair filter lets through; contacts of avatars and of loose bodies are reported alike.
"""

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.broad_phase import sweep_and_prune
from avatarsim.collision.grid import make_sweep_memory
from avatarsim.collision.manifold import Manifold, make_manifold, manifold
from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.collision.signed_distance import signed_distance, signed_distance_up_to
from avatarsim.collision.status import NOT_FINITE, OUT_OF_ROOM
from avatarsim.errors import AvatarsimError, InvalidInput, InvalidScene, StartOverlaps
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import SIMULATED
from avatarsim.model.geometry import Shapes, rest_depth
from avatarsim.model.joint_limits import cone_excess, has_cone
from avatarsim.model.skeleton import BALL, HINGES, SLIDE
from avatarsim.model.world import World
from avatarsim.scene.checks import as_number
from avatarsim.spatial.tangent import columns
from avatarsim.spatial.vec3 import Rows, Vec3
from avatarsim.tolerances import NOTHING


class Overlap(NamedTuple):
    """Two bodies, by name, that overlap more than they may: the pieces that are deepest in each other, how deep [m] beyond the
    allowed depth (`Scene.at_rest`), and the unit normal out of b into a."""

    a: str
    b: str
    pieces: tuple[int, int]
    depth: float
    normal: Vec3


def deepest_overlaps(world: World, dip: float = NOTHING, least: float = NOTHING) -> list[Overlap]:
    """Return every wanted pair that overlaps by more than `least` [m]. `dip` [m]: how deep a pair with a simulated body may, of a
    state that frames have shown: bodies at rest dip by fractions of a micrometre."""
    geo, poses, names, role = world.geometry, world.poses, world.scene.names, world.dynamics.role
    scratch, found = make_scratch(), []
    for a, b in meeting_pairs(world):
        allowed = float(rest_depth(geo.rest, a, b))
        deepest = Overlap(names[a], names[b], (-1, -1), -np.inf, (0.0, 0.0, 0.0))
        for s in range(geo.first_shape[a], geo.first_shape[a + 1]):
            for t in range(geo.first_shape[b], geo.first_shape[b + 1]):
                _, gap, n, _, _ = signed_distance(poses.vertices, geo.shapes, s, t, (0.0, 0.0, 0.0), scratch)
                if -gap - allowed > deepest.depth:
                    deepest = deepest._replace(pieces=(s, t), depth=-gap - allowed, normal=n)
        # resting contact described in decimal numbers may be off by rounding
        if deepest.depth > (dip if SIMULATED in (role[a], role[b]) else least):
            found.append(deepest)
    return found


def overlapping_pairs(world: World, dip: float = NOTHING) -> list[tuple[str, str, float]]:
    """Return every wanted pair that overlaps, by name, with its depth [m], once per pair; `dip` as in `deepest_overlaps`."""
    return [(one.a, one.b, one.depth) for one in deepest_overlaps(world, dip)]


def width(world: World, piece: int) -> float:
    """Return the least width [m] of a piece: how deep it is in itself, since the difference with itself has all its widths."""
    _, gap, _, _, _ = signed_distance(
        world.poses.vertices, world.geometry.shapes, piece, piece, (0.0, 0.0, 0.0), make_scratch()
    )
    return -float(gap)


def meeting_pairs(world: World, within: float = 0.0) -> list[tuple[int, int]]:
    """Return every wanted pair of bodies a < b whose boxes meet, each grown by half of `within` [m], in ascending order."""
    bodies, room, boxes = len(world.scene.names), 0, world.poses.hulls
    if within > 0.0:
        # and by as much as the sums round
        boxes = boxes + np.repeat([-0.5, 0.5], 3) * (within + NOTHING)
    while True:
        pairs = np.zeros((room, 2), np.int64)
        status, room = sweep_and_prune(boxes, world.geometry.wanted, make_sweep_memory(bodies, room), pairs)
        if status == NOT_FINITE:
            raise AvatarsimError("a box of the first pose is not finite: this is a defect, please report it with the scene")
        if status != OUT_OF_ROOM:
            return [(int(a), int(b)) for a, b in pairs[:room]]


def require_within_limits(world: World, slack: float = 0.0) -> None:
    """Raise InvalidScene when the first posture is beyond a joint limit, by more than `slack` [rad, m]: it could not be shown."""
    skel = world.skeleton
    for i, link in enumerate(world.scene.links):
        if skel.kind[i] in (HINGES, SLIDE):
            for j in range(skel.first_dof[i], skel.first_dof[i + 1]):
                angle, (low, high) = world.posture.angle[j], skel.limits[j]
                if not low - slack <= angle <= high + slack:
                    what = "way of the slide of {} [m]" if skel.kind[i] == SLIDE else "angle of a hinge of {} [rad]"
                    raise InvalidScene("start " + what.format(link.name), float(angle), f"{low:g} to {high:g}")
        elif skel.kind[i] == BALL and has_cone(skel.balls, i):
            excess = cone_excess(skel.balls, i, columns(world.posture.turn, i))
            if not excess <= slack:
                thing = f"start rotation of {link.name} beyond its swing and twist limits [rad]"
                raise InvalidScene(thing, float(excess), "0 or less")
    for (follower, leader), (ratio, offset) in zip(skel.follow.tolist(), skel.ratio.tolist(), strict=True):
        angle, wanted = float(world.posture.angle[follower]), ratio * float(world.posture.angle[leader]) + offset
        if not abs(angle - wanted) <= max(slack, NOTHING):
            link = world.scene.links[int(np.searchsorted(skel.first_dof, follower, "right")) - 1]
            raise InvalidScene(f"start angle or way of {link.name}, which follows another joint [rad, m]", angle, f"{wanted:g}")


def require_free(world: World, dip: float = NOTHING) -> None:
    """Raise StartOverlaps when the pose is not free; `dip` as in `overlapping_pairs`."""
    found = overlapping_pairs(world, dip)
    if found:
        raise StartOverlaps(found)


FARTHEST = 1.0
"""[m] largest gap of a query: beyond it no contact is meant, and every pair of a room would be measured."""


def no_force() -> NDArray[np.float64]:
    """Return the force of a contact for which none was computed: nan."""
    return np.full(3, np.nan)


@dataclass(frozen=True, eq=False, slots=True)
class Contact:
    """One point at which two bodies or links touch, or nearly do, in the state that is shown. World axes; arrays are read-only.

    a, b    names of the two, `a` first in the order of `scene.names`
    point   (3,) [m] half way between the two surfaces
    normal  (3,) unit vector out of b into a
    gap     [m] distance of the surfaces at this point, along the normal: of an avatar that leans on something near the setting
            `stand_off`, 0.2 mm; of loose bodies that rest micrometres; of a pair that overlaps at home beyond the depth that it
            may have (`Scene.at_rest`)
    force   (3,) [N] on `a`, and its opposite on `b`; nan unless forces are computed
    """

    a: str
    b: str
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    gap: float
    force: NDArray[np.float64] = field(default_factory=no_force)

    @property
    def normal_force(self) -> float:
        """Return the part of the force along the normal [N]."""
        return float(self.force @ self.normal)


@kernel
def contact_points(
    vertices: Rows, shapes: Shapes, a: int, b: int, within: float, depth: float, scratch: Scratch, found: Manifold
) -> tuple[int, Vec3]:
    """Return the number of contact points of pieces a and b with a gap up to ``within`` [m], left in ``found``, and their normal
    out of b; of a pair that overlaps at home a gap beyond the ``depth`` [m] that it may have."""
    status, gap, n, on_a, on_b = signed_distance_up_to(vertices, shapes, a, b, (0.0, 0.0, 0.0), within, scratch)
    if status == NOT_FINITE or not (gap + depth <= within):
        return 0, n
    return manifold(vertices, shapes, a, b, n, on_a, on_b, gap, within - depth, found)


def contacts_of(world: World, within: float, of: Collection[str] | None = None) -> tuple[Contact, ...]:
    """Return contacts of all pairs of bodies that must not overlap and are at most `within` [m] apart, in canonical order; with
    `of` only those in which one of these bodies or links takes part.

    Of two convex pieces up to eight points, as many as it takes to hold one of their faces; at least the closest.
    """
    if not 0.0 <= as_number(within) <= FARTHEST:
        raise InvalidInput("largest gap of contacts [m]", within, f"a number from 0 to {FARTHEST:g}")
    geo, vertices, names = world.geometry, world.poses.vertices, world.scene.names
    scratch, found, contacts = make_scratch(), make_manifold(), []
    for a, b in meeting_pairs(world, within):
        if of is not None and names[a] not in of and names[b] not in of:
            continue
        allowed = float(rest_depth(geo.rest, a, b))
        for s in range(geo.first_shape[a], geo.first_shape[a + 1]):
            for t in range(geo.first_shape[b], geo.first_shape[b + 1]):
                count, n = contact_points(vertices, geo.shapes, s, t, float(within), allowed, scratch, found)
                for k in range(count):
                    point, normal = 0.5 * (found.on_a[k] + found.on_b[k]), np.array(n)
                    point.flags.writeable = normal.flags.writeable = False
                    contacts.append(Contact(names[a], names[b], point, normal, float(found.gap[k]) + allowed))
    return tuple(contacts)
