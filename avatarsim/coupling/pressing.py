"""Pressing of a link held back by a simulated body: the spring of eq. 6 between the link's pose and its displaced target.

The lower loop lets no link into anything: one that a body holds lags behind the place that tracker and impulses gave it. Over
a frame the spring turns this lag into velocity; the impact of the upper loop turns the velocity into an impulse. A lag caused by
a fixed body presses on no body, and no lag is stored: once the link is free it returns at once.
"""

from avatarsim.coupling.recoil import middle
from avatarsim.coupling.spring import coupled
from avatarsim.ik.state import Contacts
from avatarsim.jit.kernel import kernel
from avatarsim.settings import CouplingSettings
from avatarsim.spatial.vec3 import Rows, Vec3, add, dot, put_row, row, scale, sub
from avatarsim.world.dynamics import SIMULATED, Array, Dynamics
from avatarsim.world.geometry import Geometry, Poses, place
from avatarsim.world.skeleton import FREE, Skeleton


@kernel
def lag(skel: Skeleton, shown: Poses, tracked: Poses, offset: Rows, link: int) -> Vec3:
    """How far a link is shown from where its tracker and the offsets of eq. 6 put it [m]."""
    b, root = skel.first + link, link
    while skel.parent[root] >= 0:
        root = skel.parent[root]
    wanted = add(middle(tracked, b), row(offset, link))
    if root != link and skel.kind[root] == FREE:
        wanted = add(wanted, row(offset, root))
    return sub(middle(shown, b), wanted)


@kernel
def press(
    geo: Geometry, skel: Skeleton, dynamics: Dynamics, contacts: Contacts, shown: Poses, offset: Rows, mass: Array,
    settings: CouplingSettings, dt: float, tracked_out: Poses, pressed_out: Rows,
) -> None:
    """Velocities pressed (nl, 3) [m/s] that links gain in dt against the simulated bodies that held them last.

    A link that several bodies hold presses on the one that holds it back most. Of tracked, boxes of these links are made here.
    """
    pressed_out[:, :] = 0.0
    for k in range(contacts.used[0]):
        a, b = contacts.pair[k, 0], contacts.pair[k, 1]
        if dynamics.role[geo.body[b]] != SIMULATED:
            continue
        link, n = geo.body[a] - skel.first, row(contacts.normal, k)
        place(geo, tracked_out, skel.first + link)
        held = dot(lag(skel, shown, tracked_out, offset, link), n)
        if held > 0.0:
            _, gained = coupled(mass[link], settings.spring, settings.damping, scale(n, held), (0.0, 0.0, 0.0), dt)
            before = row(pressed_out, link)
            if dot(gained, gained) > dot(before, before):
                put_row(pressed_out, link, gained)
