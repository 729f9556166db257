"""Inertia of the shown posture: an implicit, critically damped spring to the target, in the metric of the objective.

With u the last frame's motion beyond the target's own, p the Newton step, dq* the target's own motion and w = omega dt, a frame
is to move by

    dq* + u / (1 + w)^2 + (w / (1 + w))^2 (p - dq*)

This is backward Euler of x'' = -2 omega x' - omega^2 x, for the offset x to the nearest posture (Hairer and Wanner 1996, section
IV.3), and the least of an incremental potential (Martin and others 2011; docs/posture.md): metric, rows and certificates are
those of a frame without inertia. The two steps of a frame are Newton iterations of that one potential. With the target at rest
the same postures are fixed points as without inertia, since the spring is damped and u ends at zero.
"""

from math import inf

from avatarsim.ik.kinematics import longest_part, tangent_error
from avatarsim.ik.motion_budget import AT_REST
from avatarsim.ik.objective import LOSS_RADIUS
from avatarsim.ik.state import Avatars, IkScratch, IkState, Objective, Rig
from avatarsim.ik.target import copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Array
from avatarsim.model.skeleton import FREE, Posture
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import dot, norm, row, sub

SETTLING = 5.0
"""Time constants 1 / omega after which a critically damped spring has come within 4 % of its end."""


@kernel
def carry_momentum(
    rig: Rig, settings: PostureSettings, dt: float, posture: Posture, state_out: IkState, scratch: IkScratch
) -> None:
    """Compute the momentum of the avatars at the start of a frame of dt [s], from the last frame and the target's own motion."""
    avatars = rig.avatars
    t, inertia, w = state_out.tracking, state_out.inertia, settings.natural_frequency * dt
    for avatar in range(avatars.first_link.shape[0] - 1):
        t.keep[avatar] = 1.0 / (1.0 + w) ** 2
        t.share[avatar] = w * w * t.keep[avatar]
        ratio = dt / t.frame_time[avatar] if t.frame_time[avatar] > 0.0 else 0.0
        tangent_error(rig, avatar, inertia.shown, posture, inertia.walk)
        for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
            inertia.walk[j] *= ratio
            beyond = inertia.walk[j] - scratch.objective.target_motion[j]
            inertia.momentum[j] = beyond if t.is_led[avatar] > 0 else minmod(ratio * inertia.gone[j], beyond)
            inertia.target_motion[j], inertia.gone[j] = scratch.objective.target_motion[j], 0.0
        t.frame_time[avatar], t.is_led[avatar] = dt, 0
        copy_posture(rig, avatar, posture, inertia.shown)


@kernel
def terminal_speed(settings: PostureSettings, distance: float, dt: float) -> float:
    """Return the steady speed [m/s] of a spring whose distance [m] to the target is constant, as beyond the loss radius."""
    return settings.natural_frequency * distance / (2.0 + settings.natural_frequency * dt)


@kernel
def minmod(a: float, b: float) -> float:
    """Return the smaller of two numbers of the same sign, else 0 (van Leer 1979); 0 for nan."""
    if not a * b > 0.0:
        return 0.0
    return a if abs(a) < abs(b) else b


@kernel
def forget_momentum(rig: Rig, avatar: int, posture: Posture, state_out: IkState) -> None:
    """Set the velocity of an avatar at `posture` to zero."""
    avatars = rig.avatars
    inertia = state_out.inertia
    for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
        inertia.momentum[j], inertia.walk[j], inertia.target_motion[j], inertia.gone[j] = 0.0, 0.0, 0.0, 0.0
    state_out.tracking.is_led[avatar] = 0
    copy_posture(rig, avatar, posture, inertia.shown)


@kernel
def shorten_own(rig: Rig, avatar: int, reach: float, objective_out: Objective) -> None:
    """Scale the target's own motion of one frame down to the distance of the target, so that an avatar never overtakes it."""
    avatars = rig.avatars
    o = objective_out
    moved = longest_part(rig, avatar, o.target_motion, 1.0, 1.0 / reach)
    far = longest_part(rig, avatar, o.error, 1.0, 1.0 / reach)
    if far < moved:
        for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
            o.target_motion[j] *= far / moved


@kernel
def goal_of(avatar: int, j: int, newton: float, state: IkState, own: Array) -> float:
    """Return component j of the remaining step of this frame, for component `newton` of the Newton step."""
    gone, t = state.inertia.gone[j], state.tracking
    return float(own[j] + t.share[avatar] * (newton - own[j] + gone) + t.keep[avatar] * state.inertia.momentum[j] - gone)


@kernel
def resist(rig: Rig, avatar: int, state: IkState, objective_out: Objective) -> None:
    """Replace the Newton step by the step with inertia.

    The root is not damped towards a target that is drawn near, which moves away as the root moves. The planning avatar has no
    inertia."""
    skel, avatars = rig.skel, rig.avatars
    o, root = objective_out, avatars.first_link[avatar]
    if state.tracking.keep[avatar] == 0.0:
        return
    for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
        o.newton[j] = goal_of(avatar, j, o.newton[j], state, o.target_motion)
    offset = sub(row(o.origin, root), row(o.aim, root))
    far = norm(offset)
    if skel.kind[root] == FREE and far > 0.0:
        d, m = skel.first_dof[root], state.inertia.momentum
        speed = dot((m[d], m[d + 1], m[d + 2]), offset) / far
        share = far / (far + LOSS_RADIUS * state.tracking.reach[avatar])
        undamped = max(0.0, speed) * (1.0 - state.tracking.keep[avatar]) * share / far
        for i in range(3):
            o.newton[d + i] += undamped * offset[i]


@kernel
def resist_straight(avatars: Avatars, avatar: int, state: IkState, scratch_out: IkScratch) -> None:
    """Replace the tangent error by the step with inertia, unless the avatar is slow enough to end at its target."""
    s, step, own, inertia, far = scratch_out, scratch_out.step, scratch_out.objective.target_motion, state.inertia, 0.0
    if state.tracking.keep[avatar] == 0.0:
        return
    for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
        far = max(far, abs(step[j] - own[j] + inertia.gone[j]), abs(inertia.momentum[j]))
    if AT_REST * state.tracking.frame_time[avatar] < far < inf:
        for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
            # between two postures within limits momentum may lead out of them
            step[j] = min(max(goal_of(avatar, j, step[j], state, own), s.low[j]), s.high[j])


@kernel
def note_step(avatars: Avatars, avatar: int, step: Array, own: Array, state_out: IkState) -> None:
    """Add a step (nd) to the motion of this frame beyond the target's own."""
    for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
        state_out.inertia.gone[j] += step[j] - own[j]
