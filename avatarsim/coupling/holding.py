"""Velocities of driven links projected onto the non-penetration cone of active contacts with fixed bodies, before impacts."""

from avatarsim.ik.state import Contacts
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import along, dot, put_row, row
from avatarsim.world.dynamics import FIXED, Dynamics, Velocities
from avatarsim.world.geometry import Geometry

ROUNDS = 10
"""Times that all that holds a link is gone through: what one wall leaves may go into another. In a corner of 60 degrees each time
leaves a quarter of that; fewer would leave a hand in a corner a velocity."""


@kernel
def hold(geo: Geometry, dynamics: Dynamics, contacts: Contacts, velocities_out: Velocities) -> None:
    """Take from the velocity of each link what goes into the fixed bodies that held it last; what goes along them stays.

    A hand at a wall stands still while its user goes on: a ball that meets it must not be struck with the user's velocity. A link
    held by simulated bodies keeps its velocity, by which it pushes them.
    """
    v = velocities_out.linear
    for _ in range(ROUNDS):
        done = True
        for k in range(contacts.used[0]):
            a, other = contacts.pair[k, 0], contacts.pair[k, 1]
            if dynamics.role[geo.body[other]] == FIXED:
                n, b = row(contacts.normal, k), geo.body[a]
                into = dot(row(v, b), n)
                if into < 0.0:
                    put_row(v, b, along(row(v, b), -into, n))
                    done = False
        if done:
            break
