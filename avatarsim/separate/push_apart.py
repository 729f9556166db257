"""Push two overlapping bodies apart by their global penetration depth (Schmidl and Lin 2004, eq. 1), by pure translation."""

from avatarsim.collide.global_depth import global_depth
from avatarsim.collide.scratch import Scratch
from avatarsim.collide.status import CANCELLING, NOT_FINITE, OUT_OF_ROOM
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, norm, scale
from avatarsim.world.geometry import Geometry, Poses

STAY: Vec3 = (0.0, 0.0, 0.0)


@kernel
def lengthened(depth: Vec3, stand_off: float) -> Vec3:
    """``depth`` made longer by ``stand_off`` [m] along itself; zero stays zero: it has no direction."""
    length = norm(depth)
    return scale(depth, 1.0 + stand_off / length) if length > 0.0 else depth


@kernel
def push_apart(
    geo: Geometry, poses: Poses, a: int, b: int, share_a: float, share_b: float, stand_off: float, scratch: Scratch
) -> tuple[int, Vec3, Vec3]:
    """Translations [m] of bodies a and b that diminish their overlap: +share_a PD_g and -share_b PD_g, PD_g by eq. (1).

    PD_g is lengthened by ``stand_off``. One push clears two convex bodies; a corner between N equal walls of one body loses
    1/N of its depth, so the caller repeats. Returns (status of eq. 1, move of a, move of b); both stay where PD_g has no
    direction (CANCELLING) or cannot be had, and where nothing overlaps.
    """
    status, depth, count = global_depth(poses.vertices, geo.shapes, geo.first_shape, a, b, scratch)
    if count == 0 or status == CANCELLING or status == NOT_FINITE or status == OUT_OF_ROOM:
        return status, STAY, STAY
    depth = lengthened(depth, stand_off)
    return status, scale(depth, share_a), scale(depth, -share_b)
