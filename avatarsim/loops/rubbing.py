"""Slip velocity of driven contacts: the user's, or the displayed one where a contact or a limit holds the driven body back."""

from avatarsim.impact.contacts import DRIVEN_A, axis
from avatarsim.impact.relative_velocity import point_velocity, tangential_velocity
from avatarsim.jit.kernel import kernel
from avatarsim.loops.upper_memory import Memory
from avatarsim.spatial.tangent import columns, step_between, turned
from avatarsim.spatial.vec3 import dot, norm, put_row, row, scale, sub
from avatarsim.world.dynamics import Velocities
from avatarsim.world.geometry import Poses

SEEN = 0.005
"""[m/s] by which a driven body must be displayed slower than its user along a surface to count as held back there. The springs of
eq. 6 make smaller differences; larger: slow users drag bodies along. 0: a pushed box sticks to a hand that its spring lets slide,
and takes three times as long to solve."""


@kernel
def note_shown(poses: Poses, dt: float, memory: Memory, b: int) -> None:
    """Fill ``shown_linear``, ``shown_angular`` of driven body b: from where it was a frame of dt seconds ago to where it is."""
    before, start = memory.trial, columns(memory.trial.rotation, b)
    put_row(memory.shown_linear, b, scale(sub(row(poses.position, b), row(before.position, b)), 1.0 / dt))
    turn = turned(start, step_between(start, columns(poses.rotation, b)))
    put_row(memory.shown_angular, b, scale(turn, 1.0 / dt))


@kernel
def note_drift(velocities: Velocities, memory: Memory, k: int) -> None:
    """Fill ``drift`` of contact k of a driven body: the part of its user's tangential velocity that is not displayed.

    A free driven body strikes with the user's velocity. A hand that is held back, itself (see `coupling.holding`) or by its arm
    or a limit, must not drag a body like a conveyor belt while its user goes on: there the displayed, slower velocity counts.
    """
    contacts, side = memory.contacts, 0 if memory.contacts.driven[k] == DRIVEN_A else 1
    b, n = contacts.body[k, side], axis(contacts, k, 0)
    arm = row(contacts.arm_a, k) if side == 0 else row(contacts.arm_b, k)
    user = tangential_velocity(n, point_velocity(row(velocities.linear, b), row(velocities.angular, b), arm))
    shown = tangential_velocity(n, point_velocity(row(memory.shown_linear, b), row(memory.shown_angular, b), arm))
    beyond = sub(user, shown) if norm(shown) + SEEN < norm(user) else (0.0, 0.0, 0.0)
    for i in range(2):
        along_tangent = dot(axis(contacts, k, 1 + i), beyond)
        contacts.drift[k, i] = along_tangent if side == 0 else -along_tangent
