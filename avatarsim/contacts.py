"""Contacts of the state that is shown: signed distances and contact manifolds of near pairs, found when they are asked for.

The narrow phase is that of the frame (GJK, Gilbert et al. 1988, and EPA; faces clipped as by Sutherland and Hodgman, 1974), but
asked cold and outside the frame: what is not asked for costs nothing, and asking changes nothing. Contacts of avatars and of
loose bodies are told alike.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.scratch import Scratch, make_scratch
from avatarsim.collide.signed_distance import signed_distance_up_to
from avatarsim.collide.status import NOT_FINITE
from avatarsim.errors import InvalidInput
from avatarsim.jit.kernel import kernel
from avatarsim.motion.manifold import Manifold, make_manifold, manifold
from avatarsim.scene.checks import as_number
from avatarsim.spatial.vec3 import Rows, Vec3
from avatarsim.start_check import meeting_pairs
from avatarsim.world.shapes import Shapes
from avatarsim.world.world import World

FARTHEST = 1.0
"""[m] largest gap that is asked for: beyond it no contact is meant, and every pair of a room would be measured."""


@dataclass(frozen=True, eq=False, slots=True)
class Contact:
    """One point at which two bodies or links touch, or nearly do, in the state that is shown. World axes; arrays are read-only.

    a, b    names of the two, `a` first in the order of `scene.names`
    point   (3,) [m] half way between the two surfaces
    normal  (3,) unit vector out of b into a
    gap     [m] distance of the surfaces at this point, along the normal: of an avatar that leans on something near the setting
            `stand_off`, 0.2 mm; of loose bodies that rest micrometres
    """

    a: str
    b: str
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    gap: float


@kernel
def contact_points(
    vertices: Rows, shapes: Shapes, a: int, b: int, within: float, scratch: Scratch, found: Manifold
) -> tuple[int, Vec3]:
    """How many contact points of pieces a and b have a gap up to ``within`` [m], left in ``found``, and their normal out of b."""
    status, gap, n, on_a, on_b = signed_distance_up_to(vertices, shapes, a, b, (0.0, 0.0, 0.0), within, scratch)
    if status == NOT_FINITE or not (gap <= within):
        return 0, n
    return manifold(vertices, shapes, a, b, n, on_a, on_b, gap, within, found)


def contacts_of(world: World, within: float) -> tuple[Contact, ...]:
    """Contacts of all pairs of bodies that must not overlap and are at most `within` [m] apart, in canonical order.

    Of two convex pieces up to eight points, as many as it takes to hold one of their faces; at least the closest.
    """
    if not 0.0 <= as_number(within) <= FARTHEST:
        raise InvalidInput("largest gap of contacts [m]", within, f"a number from 0 to {FARTHEST:g}")
    geo, vertices, names = world.geometry, world.poses.vertices, world.scene.names
    scratch, found, contacts = make_scratch(), make_manifold(), []
    for a, b in meeting_pairs(world, within):
        for s in range(geo.first_shape[a], geo.first_shape[a + 1]):
            for t in range(geo.first_shape[b], geo.first_shape[b + 1]):
                count, n = contact_points(vertices, geo.shapes, s, t, float(within), scratch, found)
                for k in range(count):
                    point, normal = 0.5 * (found.on_a[k] + found.on_b[k]), np.array(n)
                    point.flags.writeable = normal.flags.writeable = False
                    contacts.append(Contact(names[a], names[b], point, normal, float(found.gap[k])))
    return tuple(contacts)
