"""The active contacts of the last step of the checked posture, as the coupling reads them."""

from avatarsim.ik.state import Contacts
from avatarsim.kernel import kernel
from avatarsim.posture.certificate import axis_of
from avatarsim.posture.workspace import COUNT, Memory
from avatarsim.spatial.vec3 import put_row
from avatarsim.world.geometry import Geometry
from avatarsim.world.skeleton import Skeleton


@kernel
def list_active(geo: Geometry, skel: Skeleton, memory: Memory, contacts_out: Contacts) -> None:
    """List the contact rows of the last step whose multiplier is above zero, each with the direction that now separates the
    pair."""
    rows, c, kept = memory.rows, contacts_out, 0
    for k in range(rows.size[COUNT]):
        if rows.pair[k, 0] < 0 or not (rows.multiplier[k] > 0.0):
            continue
        a, b = rows.pair[k, 0], rows.pair[k, 1]
        c.pair[kept, 0], c.pair[kept, 1], c.multiplier[kept] = a, b, rows.multiplier[k]
        put_row(c.normal, kept, axis_of(memory, a - geo.first_shape[skel.first], b))
        kept += 1
    c.used[0] = kept
