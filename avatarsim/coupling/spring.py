"""Equation 6: the spring between tracker and driven body, solved exactly for any frame time.

Pressing of a link held back by a simulated body: the spring of eq. 6 between the link's pose and its displaced target.

The lower loop lets no link into anything: one that a body holds lags behind the place that tracker and impulses gave it. Over
a frame the spring turns this lag into velocity; the impact of the upper loop turns the velocity into an impulse. A lag caused by
a fixed body presses on no body, and no lag is stored: once the link is free it returns at once.
"""

from math import cos, exp, sin, sqrt

from avatarsim.coupling.reaction import middle
from avatarsim.ik.state import Contacts
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import SIMULATED, Dynamics
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.model.skeleton import FREE, Skeleton
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, dot, put_row, row, scale, sub

NEARLY_CRITICAL = 1e-3
"""|frequency x time| below which sin x/x is taken by its series; x^6/5040 is then far below rounding. Larger: the
series is off; smaller: differences cancel."""


@kernel
def decay(mass: float, spring: float, damping: float, t: float) -> tuple[float, float]:
    """The two solutions of m x'' = -K x - R x': (C, S) with C = (1, rate -s) and S = (0, rate 1) at t = 0.

    With s = R / 2m and w^2 = K/m - s^2: C = e^(-st) cos wt and S = e^(-st) sin(wt)/w, cosh and sinh when over-damped
    (written with decaying exponentials only, which cannot overflow), and their common limit when critically damped.
    """
    s = 0.5 * damping / mass
    square = spring / mass - s * s
    w = sqrt(abs(square))
    x = w * t
    if x < NEARLY_CRITICAL:
        q = square * t * t
        fade = exp(-s * t)
        return fade * (1.0 - q / 2.0 + q * q / 24.0), fade * t * (1.0 - q / 6.0 + q * q / 120.0)
    if square > 0.0:
        fade = exp(-s * t)
        return fade * cos(x), fade * sin(x) / w
    # w - s would cancel for a weak spring
    slow, fast = exp(-spring / mass / (s + w) * t), exp(-(s + w) * t)
    return 0.5 * (slow + fast), 0.5 * (slow - fast) / w


@kernel
def coupled(
    mass: float, spring: float, damping: float, offset: Vec3, velocity: Vec3, t: float
) -> tuple[Vec3, Vec3]:
    """Eq. 6: offset [m] and velocity [m/s] after ``t`` seconds of m x'' = -K x - R x', exact and stable for any t.

    ``offset`` is the driven body's position relative to the tracker's; mass > 0 [kg], spring K > 0 [N/m], damping R >= 0.
    """
    c, s = decay(mass, spring, damping, t)
    half = 0.5 * damping / mass
    moved = add(scale(offset, c + half * s), scale(velocity, s))
    return moved, along(scale(velocity, c - half * s), -spring / mass * s, offset)


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
    geo: Geometry, skel: Skeleton, dynamics: Dynamics, contacts: Contacts, shown: Poses, offset: Rows, dt: float,
    tracked_out: Poses, pressed_out: Rows,
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
            drive, own = dynamics.drive, skel.first + link
            _, gained = coupled(
                drive.mass[own], drive.stiffness[own], drive.damping[own], scale(n, held), (0.0, 0.0, 0.0), dt
            )
            before = row(pressed_out, link)
            if dot(gained, gained) > dot(before, before):
                put_row(pressed_out, link, gained)
