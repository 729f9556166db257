"""Contact forces of the last step, multipliers times normals: what they press on each link with, and how they bend the
Lagrangian."""

from avatarsim.ik.objective import stretch
from avatarsim.ik.state import Avatars, ConstraintRows, IkState, RowKind
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import add, put_row, row, scale
from avatarsim.world.geometry import Geometry
from avatarsim.world.skeleton import Skeleton

CONTACT = int(RowKind.CONTACT)


@kernel
def forget_forces(avatars: Avatars, avatar: int, state_out: IkState) -> None:
    """Nothing presses on the links of an avatar."""
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        put_row(state_out.force, link, (0.0, 0.0, 0.0))
        state_out.bend[link] = 0.0


@kernel
def note_forces(geo: Geometry, skel: Skeleton, avatars: Avatars, rows: ConstraintRows, state_out: IkState) -> None:
    """Add what the contact rows of a solved step press on each link with."""
    s = state_out
    for k in range(rows.used[0]):
        if rows.kind[k] != CONTACT or not (rows.multiplier[k] > 0.0):
            continue
        for side in range(2):
            link = geo.body[rows.pair[k, side]] - skel.first
            if link < 0:
                continue
            push = rows.multiplier[k] / s.tracking.share[avatars.avatar[link]]
            force = scale(row(rows.normal, k), push if side == 0 else -push)
            arm = (rows.arm[k, 3 * side], rows.arm[k, 3 * side + 1], rows.arm[k, 3 * side + 2])
            put_row(s.force, link, add(row(s.force, link), force))
            s.bend[link] += stretch(force, arm)
