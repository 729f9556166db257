"""Driven bodies under load in the solve of all contacts: equation 6 in the tracker's frame, by implicit Euler.

The lag u of a driven body behind its tracker obeys m u'' = -K u - R u' + f. Over h seconds, with the tracker's velocity v_t, this
makes it a body of mass m + h R + h^2 K that without contact would have the velocity v_t + (m u' - h K u) / (m + h R + h^2 K).
So a hand without contact has no lag, one at rest presses with K u exactly, and no K makes it unstable. Turns obey the same law
with m, R and K times the square of the body's size.
"""

from math import inf, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.path import spun
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DRIVEN, SIMULATED, DriveState, Dynamics, Velocities
from avatarsim.model.geometry import Poses
from avatarsim.rigid.contacts import axis, impulse_of
from avatarsim.rigid.state import Memory
from avatarsim.spatial.tangent import columns, turn_of
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, limited, norm, put_row, row, scale, sub
from avatarsim.tolerances import NOTHING, SMALL

Index = NDArray[np.int64]


@kernel
def lag_of(drive: DriveState, poses: Poses, b: int, now: float, dt: float) -> tuple[Vec3, Vec3]:
    """Return the lag [m], [rad] of body b behind its tracker, ``now`` seconds into a frame of dt seconds."""
    left = dt - now
    step = along(scale(row(drive.linear, b), left), 0.5 * left * now, row(drive.ramp, b))
    turn = along(scale(row(drive.angular, b), left), 0.5 * left * now, row(drive.ramp_turn, b))
    tracked = spun(columns(drive.turn, b), turn, -1.0)
    return sub(row(poses.position, b), sub(row(drive.position, b), step)), turn_of(tracked, columns(poses.rotation, b))


@kernel
def aim(drive: DriveState, poses: Poses, velocities: Velocities, memory: Memory, b: int, now: float, dt: float, h: float) -> None:
    """Set the effective mass of coupled body b and its velocity at the end of a substep without contact (eq. 6).

    The substep begins ``now`` seconds into a frame of dt seconds and lasts h seconds. The force of a blocked body, and its torque
    at the size of the body, are constant: see `bound_forces`. The rate at which a lag is made up is limited to ``fastest``, so
    that a jump of the tracker throws nothing, and to the speed that the largest force can brake.
    """
    middle = now + 0.5 * (h - dt)
    put_row(drive.user, b, along(row(drive.linear, b), middle, row(drive.ramp, b)))
    put_row(drive.user_turn, b, along(row(drive.angular, b), middle, row(drive.ramp_turn, b)))
    u, turn = lag_of(drive, poses, b, now, dt)
    # a link without pieces has no size
    size = max(memory.span[b], SMALL)
    mass, v = spring_step(drive, b, u, row(drive.lag, b), drive.blocked[b] == 1, h)
    put_row(velocities.linear, b, add(v, row(drive.user, b)))
    turning = scale(turn, size), scale(row(drive.lag_turn, b), size)
    mass_turning, w = spring_step(drive, b, turning[0], turning[1], drive.blocked_turn[b] == 1, h)
    put_row(velocities.angular, b, add(limited(scale(w, 1.0 / size), drive.fastest_turn[b]), row(drive.user_turn, b)))
    memory.masses.inverse_mass[b] = 1.0 / mass
    for i in range(3):
        for j in range(3):
            memory.inertia[b, i, j] = size * size * mass_turning if i == j else 0.0
            memory.masses.inverse_inertia[b, i, j] = 1.0 / (size * size * mass_turning) if i == j else 0.0


@kernel
def spring_step(drive: DriveState, b: int, u: Vec3, lag: Vec3, is_blocked: bool, h: float) -> tuple[float, Vec3]:
    """Return (effective mass [kg], velocity of a lag u [m] after h seconds without contact [m/s])."""
    m, k, r, fastest = drive.mass[b], drive.stiffness[b], drive.damping[b], min(drive.fastest[b], braked(drive, b, norm(u)))
    if is_blocked:
        # a body that the force would make faster in one substep counts as heavier
        force, wanted = drive.largest_force[b], along(scale(lag, r), k, u)
        mass = max(m, h * force / drive.fastest[b])
        return mass, along(limited(lag, fastest), -h * force / (mass * max(norm(wanted), SMALL)), wanted)
    mass = m + h * r + h * h * k
    return mass, limited(along(scale(lag, m / mass), -h * k / mass, u), fastest)


@kernel
def braked(drive: DriveState, b: int, lag: float) -> float:
    """Return the speed [m/s] of a lag [m] that the largest force brakes on this way."""
    return sqrt(2.0 * drive.largest_force[b] * lag / drive.mass[b]) + SMALL if lag > 0.0 else inf


@kernel
def bound_forces(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index, now: float, dt: float, h: float) -> bool:
    """Compare the forces of springs and dampers in a solved substep with the largest; return whether other bodies are blocked.

    An active set: a body whose force exceeds the largest gets that force alone, and the substep is solved anew.
    """
    drive, changed = dynamics.drive, False
    for m in range(members.shape[0]):
        b = members[m]
        if drive.coupled[b] == 0 or drive.largest_force[b] == inf:
            continue
        u, turn = lag_of(drive, poses, b, now, dt)
        size, k, r = max(memory.span[b], SMALL), drive.stiffness[b], drive.damping[b]
        lag = sub(row(memory.linear_end, b), row(drive.user, b))
        lag_turn = sub(row(memory.angular_end, b), row(drive.user_turn, b))
        force = norm(along(scale(u, k), r + h * k, lag))
        torque = size * norm(along(scale(turn, k), r + h * k, lag_turn))
        most = drive.largest_force[b]
        straight, turning = 1 if force > most else 0, 1 if torque > most else 0
        changed = changed or straight != drive.blocked[b] or turning != drive.blocked_turn[b]
        drive.blocked[b], drive.blocked_turn[b] = straight, turning
    return changed


@kernel
def presses(dynamics: Dynamics, other: int) -> bool:
    """Return whether body ``other`` puts a driven body that it touches under load: loose ones, and moving ones that give way."""
    drive = dynamics.drive
    yields = drive.moves[other] == 1 and (drive.coupled[other] == 1 or drive.stiffness[other] == 0.0)
    return bool(dynamics.role[other] == SIMULATED or yields)


@kernel
def aim_all(
    dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, now: float, dt: float, h: float
) -> None:
    """Run `aim` for the members that are coupled."""
    for m in range(members.shape[0]):
        if dynamics.drive.coupled[members[m]] == 1:
            aim(dynamics.drive, poses, velocities, memory, members[m], now, dt, h)


@kernel
def approach_velocities(dynamics: Dynamics, memory: Memory, members: Index) -> None:
    """Compute ``spare_linear``, ``spare_angular``: the approach velocities for restitution.

    The spring of a coupled body does not count: a pressing hand would otherwise bounce in every substep.
    """
    drive, sub_ = dynamics.drive, memory.substeps
    for m in range(members.shape[0]):
        b = members[m]
        v, w = row(memory.linear_end, b), row(memory.angular_end, b)
        if drive.coupled[b] == 1:
            v, w = add(row(drive.user, b), row(drive.lag, b)), add(row(drive.user_turn, b), row(drive.lag_turn, b))
        put_row(sub_.spare_linear, b, v)
        put_row(sub_.spare_angular, b, w)


@kernel
def arc_correction(w: Vec3, r: Vec3, h: float) -> Vec3:
    """Return the mean velocity over h seconds of a vector r that turns at w, less its first velocity w x r [m/s] (Rodrigues)."""
    angle = h * norm(w)
    if not (angle * angle * norm(r) > h * NOTHING):
        return (0.0, 0.0, 0.0)
    v, half = cross(w, r), sin(0.5 * angle)
    return along(scale(v, sin(angle) / angle - 1.0), 2.0 * h * (half / angle) ** 2, cross(w, v))


@kernel
def follow_arcs(dynamics: Dynamics, memory: Memory, h: float) -> None:
    """Set the friction targets at driven bodies so that contact points follow their arcs.

    Bodies move straight within a substep and rotate about their centres. Without the centripetal term a load on a turntable
    drifts outwards, without the next one forwards. ``spare_angular``: angular velocities at the start.
    """
    contacts, spin = memory.contacts, memory.substeps.spare_angular
    for k in range(contacts.used[0]):
        if dynamics.role[contacts.body[k, 0]] != DRIVEN and dynamics.role[contacts.body[k, 1]] != DRIVEN:
            continue
        w_a, w_b = row(spin, contacts.body[k, 0]), row(spin, contacts.body[k, 1])
        apart = sub(arc_correction(w_a, row(contacts.arm_a, k), h), arc_correction(w_b, row(contacts.arm_b, k), h))
        for i in range(2):
            contacts.slide[k, i] -= dot(axis(contacts, k, 1 + i), apart)


@kernel
def note_lag(dynamics: Dynamics, velocities: Velocities, members: Index) -> None:
    """Store the velocities of coupled members relative to their trackers."""
    drive = dynamics.drive
    for m in range(members.shape[0]):
        b = members[m]
        if drive.coupled[b] == 1:
            put_row(drive.lag, b, sub(row(velocities.linear, b), row(drive.user, b)))
            put_row(drive.lag_turn, b, sub(row(velocities.angular, b), row(drive.user_turn, b)))


@kernel
def note_load(dynamics: Dynamics, memory: Memory) -> None:
    """Mark driven bodies that others press on (`presses`) in the last solve; sum impulses of loose bodies on coupled ones."""
    contacts, role = memory.contacts, dynamics.role
    for k in range(contacts.used[0]):
        if contacts.impulse[k, 0] > 0.0:
            for side in range(2):
                b, other = contacts.body[k, side], contacts.body[k, 1 - side]
                if role[b] == DRIVEN and presses(dynamics, other):
                    dynamics.drive.loaded[b] = 1
                    if dynamics.drive.coupled[b] == 1 and role[other] == SIMULATED:
                        j = impulse_of(contacts, k)
                        put_row(memory.received, b, along(row(memory.received, b), 1.0 if side == 0 else -1.0, j))


@kernel
def is_kinematic(dynamics: Dynamics, b: int) -> bool:
    """Return whether body b is driven and keeps its pose in the upper loop."""
    return bool(dynamics.role[b] == DRIVEN and dynamics.drive.coupled[b] == 0)
