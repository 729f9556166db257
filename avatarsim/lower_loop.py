"""Lower loop of method `default` as the frame sees it: constrained inverse kinematics, for avatars without a load.

Lower loop without overlap removal, for scenes that switch it off: the tracker's posture is shown as it is.
"""

from typing import Annotated, ClassVar, NamedTuple

import numpy as np

from avatarsim.counters import Tally
from avatarsim.coupling.coupled_bodies import enable_coupling, exclude_coupled, freeze_coupled, note_blocked, return_coupled
from avatarsim.coupling.moving_bodies import load_moving
from avatarsim.coupling.tracked_motion import (
    TrackedMotion,
    last_and_now,
    make_tracked_motion,
    no_tracked_motion,
    project_velocities,
    receive,
    relax,
    track_velocities,
)
from avatarsim.engine import Snapshot
from avatarsim.errors import InvalidSnapshot
from avatarsim.ik.broad_phase import notice_bodies
from avatarsim.ik.inertia import forget_momentum
from avatarsim.ik.kinematics import carry_avatar, place_avatar, tangent_error
from avatarsim.ik.make import make_solver
from avatarsim.ik.solve import begin_frame, solve
from avatarsim.ik.sqp_step import copy_poses, forget_forces
from avatarsim.ik.state import (
    ADOPTED,
    BAD_QUERIES,
    COUNT_NAMES,
    DROPPED,
    FOLLOWING,
    OUT_OF_WORK,
    PLANNING,
    WAITING,
    Avatars,
    IkScratch,
    IkState,
    Mode,
    Rig,
    state_is_sound,
)
from avatarsim.ik.target import clip_to_limits, copy_posture, largest
from avatarsim.jit.arena import pack, view_arena
from avatarsim.jit.kept import FLAG, NOT_KEPT
from avatarsim.jit.kernel import entry_kernel, kernel
from avatarsim.jit.layout import Array, Index, IndexLine
from avatarsim.model.skeleton import Posture, carry, forward
from avatarsim.model.world import Target, TargetParts, World, WorldParts
from avatarsim.planner.follow_path import aim_along_paths
from avatarsim.planner.state import Plan, PlanningAvatar, make_planner, plan_is_sound
from avatarsim.planner.supervisor import drop_paths, supervise
from avatarsim.rigid.state import trail_snapshots
from avatarsim.settings import CouplingSettings, PostureSettings

STATUS_PLACES = tuple((COUNT_NAMES[place], place) for place in (BAD_QUERIES, DROPPED, WAITING, OUT_OF_WORK, PLANNING, FOLLOWING))
"""Names and indices of the counts that a frame record shows as statuses."""

STEPS_KEPT = 64
"""Most steps of one frame whose poses a recording keeps; more are counted. Each island takes a step of its own."""

TRACK = int(Mode.TRACK)

NOT_KNOWN = np.zeros(0, dtype=np.int64)
"""Flags of bodies that may have moved, where that is not known."""


class IkParts(NamedTuple):
    """Contents of the arena of the lower loop; `coupled`: whether the coupling acts; lost (1): 1 while tracking is lost."""

    coupled: bool
    lost: Annotated[IndexLine, FLAG]
    trackers: TrackedMotion
    settings: Annotated[PostureSettings, NOT_KEPT]
    avatars: Annotated[Avatars, NOT_KEPT]
    state: IkState
    working: Annotated[IkScratch, NOT_KEPT]
    plan: Plan
    planning_avatar: Annotated[PlanningAvatar, NOT_KEPT]


@kernel
def solve_postures(w: WorldParts, own: IkParts, tracker: Posture, dt: float, moving: Index) -> None:
    """Solve for the postures of a frame of dt [s], or, with 0, go on within it: within its motion budget."""
    rig, settings, state, working = Rig(w.geometry, w.skeleton, own.avatars), own.settings, own.state, own.working
    posture, poses, plan, planning_avatar = w.posture, w.poses, own.plan, own.planning_avatar
    begin_frame(rig, settings, tracker, dt, moving, posture, poses, state, working)
    freeze_coupled(rig, w.dynamics, state)
    if dt > 0.0:
        drop_paths(rig, tracker, posture, poses, plan, planning_avatar, state, working)
    aim_along_paths(rig, settings, dt, posture, poses, plan, state, working)
    solve(rig, settings, posture, poses, state, working)
    if dt > 0.0:
        supervise(rig, settings, tracker, dt, posture, poses, plan, planning_avatar, state, working)


@kernel
def step_avatars(world: Index, target: Index, lower: Index, dt: float, moving: Index) -> None:
    """Follow the tracker's posture for a frame of dt [s]: velocities of links, avatars under load, then the postures.

    The arenas are those of a world, its target and its lower loop. `moving` (nb): 1 for bodies that may have moved; empty if
    that is not known.
    """
    w, own, tracker = view_arena(world, WorldParts), view_arena(lower, IkParts), view_arena(target, TargetParts).posture
    geometry, skeleton, posture, trackers, state = w.geometry, w.skeleton, w.posture, own.trackers, own.state
    rig = Rig(geometry, skeleton, own.avatars)
    if trackers.turn[0] >= 0:
        track_velocities(skeleton, tracker, dt, w.velocities, trackers)
        if own.coupled:
            note_blocked(geometry, w.dynamics, state.contacts)
            relax(skeleton, w.dynamics.drive, dt, tracker, w.velocities)
            project_velocities(geometry, w.dynamics, state.contacts, w.velocities)
            before, now = last_and_now(trackers)
            load_moving(skeleton, w.dynamics, w.poses, before, now, dt, 2.0 * own.settings.stand_off)
            exclude_coupled(rig, w.dynamics, before, now, posture, dt, tracker, w.velocities)
    solve_postures(w, own, tracker, dt, moving)


@kernel
def resume_after_contacts(world: Index, target: Index, lower: Index, received: Array, moving: Index) -> None:
    """Resume the postures after the upper loop: links receive impulses (nb, 3) [N s], and those that were blocked by bodies
    that are `moving` (nb) now go on."""
    w, own, tracker = view_arena(world, WorldParts), view_arena(lower, IkParts), view_arena(target, TargetParts).posture
    if own.coupled:
        rig = Rig(w.geometry, w.skeleton, own.avatars)
        receive(w.skeleton, w.dynamics.drive, received)
        return_coupled(rig, w.dynamics, w.poses, w.posture, tracker, own.state, own.working)
    if moving.any() and own.state.contacts.used[0] > 0:
        solve_postures(w, own, tracker, 0.0, moving)


@entry_kernel
def show_posture(world: Index, lower: Index) -> None:
    """Write poses of all avatars at the world's posture, and nothing else."""
    w, own = view_arena(world, WorldParts), view_arena(lower, IkParts)
    rig = Rig(w.geometry, w.skeleton, own.avatars)
    for avatar in range(own.avatars.first_link.shape[0] - 1):
        carry_avatar(rig, avatar, w.posture, own.working.still, w.poses, own.working.axes)
        place_avatar(rig, avatar, w.poses)


@entry_kernel
def place_avatars(world: Index, target: Index, lower: Index) -> None:
    """Place all avatars at the world's posture, which was written: their poses, and no contacts from elsewhere. Their users are
    at the target's, and have been there."""
    w, own, tracker = view_arena(world, WorldParts), view_arena(lower, IkParts), view_arena(target, TargetParts).posture
    rig, posture, poses = Rig(w.geometry, w.skeleton, own.avatars), w.posture, w.poses
    avatars, state, working, tracking = own.avatars, own.state, own.working, own.state.tracking
    clip_to_limits(rig, tracker, tracking, state.target_before)
    for avatar in range(avatars.first_link.shape[0] - 1):
        carry_avatar(rig, avatar, posture, working.still, poses, state.axes)
        place_avatar(rig, avatar, poses)
        copy_poses(rig, avatar, poses, working.trial)
        copy_posture(rig, avatar, tracker, state.tracker_before)
        forget_forces(avatars, avatar, state)
        tracking.mode[avatar], tracking.has_model[avatar], tracking.has_arrived[avatar] = TRACK, 0, 0
        tracking.stalled[avatar], tracking.since[avatar], tracking.objective[avatar] = 0.0, 0.0, 0.0
        tracking.speed[avatar] = 0.0
        forget_momentum(rig, avatar, posture, state)
    state.touching.used[0], state.contacts.used[0] = 0, 0
    state.pairs.step[0] += 1


@entry_kernel
def resume_tracking(world: Index, target: Index, lower: Index) -> None:
    """Resume tracking, found again at the target: the way there since it was lost is no motion of the users. It is caught up
    with, as fast as after a motion of that speed, and no velocity comes of it."""
    w, own, tracker = view_arena(world, WorldParts), view_arena(lower, IkParts), view_arena(target, TargetParts).posture
    rig, avatars, state, working = Rig(w.geometry, w.skeleton, own.avatars), own.avatars, own.state, own.working
    clip_to_limits(rig, tracker, state.tracking, working.target)
    for avatar in range(avatars.first_link.shape[0] - 1):
        dt = state.tracking.frame_time[avatar]
        tangent_error(rig, avatar, state.target_before, working.target, working.step)
        largest_step = largest(working.step, avatars.first_dof[avatar], avatars.first_dof[avatar + 1])
        if dt > 0.0:
            state.tracking.speed[avatar] = max(state.tracking.speed[avatar], largest_step / dt)
        copy_posture(rig, avatar, working.target, state.target_before)
        copy_posture(rig, avatar, tracker, state.tracker_before)
    if own.trackers.turn[0] >= 0:
        _, last = last_and_now(own.trackers)
        carry(w.skeleton, tracker, own.trackers.still, last, own.trackers.axes)


class IkLoop:
    """The driven bodies of a world: every state shown was certified from the last one."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ("_known", "_reported")
    WRITTEN: ClassVar[tuple[str, ...]] = ("words",)

    def __init__(
        self, world: World, settings: PostureSettings, coupling: CouplingSettings, seed: int = 0, *, record: bool = False
    ) -> None:
        self.world, self._moving, self._known, self._reported = world, NOT_KNOWN, NOT_KNOWN, 0
        solver = make_solver(
            world.geometry, world.skeleton, world.posture, world.poses, STEPS_KEPT if record else 0, world.link_friction()
        )
        # without dynamics nothing gives back the momentum that pressing took, and the coupling would run away
        coupled = world.scene.effects.coupling and world.scene.effects.dynamics
        if coupled:
            enable_coupling(world.drive, world.skeleton, settings)
        trackers = (
            make_tracked_motion(world.skeleton, world.drive, world.posture, world.poses, coupling)
            if world.scene.effects.dynamics else no_tracked_motion(world.poses)
        )
        planner = make_planner(
            world.geometry, world.skeleton, *solver[:2], world.posture, world.poses, np.array(world.scene.gravity), seed
        )
        self.settings = settings
        self.words, own = pack(
            IkParts(coupled, np.zeros(1, dtype=np.int64), trackers, settings, *solver, *planner)
        )
        self._parts = own
        self.trackers, self.avatars, self.state, self.working = own.trackers, own.avatars, own.state, own.working
        self.lost = own.lost
        self.plan, self.planning_avatar = own.plan, own.planning_avatar
        self._link_weight = self.avatars.link_weight.copy()

    def weigh_links(self, factors: Array) -> None:
        """Multiply the weight of each link's origin (links,) in the objective, in place of earlier factors."""
        self.avatars.link_weight[:] = self._link_weight * factors

    def begin(self) -> Index:
        """Begin a frame; return flags (nb) of bodies that may have moved since the last one, as `step_avatars` takes them."""
        known, self._reported = self._known, 0
        # the first frame checks all bodies
        self._known = self._moving
        return known

    def retained_state(self) -> IkParts:
        """Return what passes from frame to frame."""
        return self._parts

    def resume(self, begun: bool) -> None:
        """Continue from a new state, of which a frame has, or has not, begun; InvalidSnapshot if it contradicts itself."""
        is_sound = state_is_sound(self.world.geometry, self.world.skeleton, self.avatars, self.state)
        if not is_sound or not plan_is_sound(self.plan):
            raise InvalidSnapshot(
                "state of the posture solver", "pairs, avatars or nodes that are not there", "places of this scene"
            )
        # avatars too are where the state has them, before their islands are solved for
        geo, link = self.world.geometry, self.world.skeleton.first
        piece = geo.first_shape[link]
        firsts = link, link, geo.shapes.start[piece], piece, link
        for trial, shown, first in zip(self.working.trial, self.world.poses, firsts, strict=True):
            trial[first:] = shown[first:]
        # bodies that have not moved since keep their cached axes
        notice_bodies(self.world.geometry, self.world.skeleton, self.world.poses, NOT_KNOWN, self.working)
        self._known, self._reported = self._moving if begun else NOT_KNOWN, 0

    def show(self) -> None:
        """Show the world's posture, which was written: links are placed there; nothing else changes."""
        show_posture(self.world.words, self.words)

    def place_avatars(self, target: Target) -> None:
        """Place avatars at the world's posture, which was written, their users at the target, and nothing has touched yet."""
        place_avatars(self.world.words, target.words, self.words)

    def note_tracking(self, is_lost: bool, target: Target) -> None:
        """Note whether tracking is lost in this frame, whose target was read."""
        if self.lost[0] and not is_lost:
            resume_tracking(self.world.words, target.words, self.words)
        self.lost[0] = is_lost

    def set_moving(self, moving: Index) -> None:
        """Check only bodies that `moving` (nb) names from now on: the upper loop keeps which moved in its last frame."""
        self._moving = moving

    def look_at_all(self) -> None:
        """Check all bodies in the next frame, since fixed ones were put elsewhere."""
        self._known = NOT_KNOWN

    def passed(self, time: float) -> tuple[Snapshot, ...]:
        """Return the states after the steps of this frame that were taken since the last call, at `time` [s], if the frame is
        recorded: links as they were left then, all else as it is now."""
        reported, self._reported = self._reported, self.working.counts.item(ADOPTED)
        return trail_snapshots(self.world, self.working.trail[reported : self._reported], time)

    def counts(self) -> Tally:
        """Return the work done in the last frame."""
        return Tally(COUNT_NAMES, self.working.counts.tobytes())

    def statuses(self) -> dict[str, int]:
        """Return counts of failures in the last frame, by name."""
        counts = self.working.counts.tolist()
        found = {name: counts[place] for name, place in STATUS_PLACES if counts[place]}
        if (recorded := len(self.working.trail)) and (lost := counts[ADOPTED] - recorded) > 0:
            found["steps not recorded"] = lost
        return found


class TrackedLoop:
    """The driven bodies of a world at the tracker's posture, whatever they overlap."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ()
    WRITTEN: ClassVar[tuple[str, ...]] = ("_still", "_axes")

    def __init__(self, world: World) -> None:
        self.world = world
        degrees = int(world.skeleton.first_dof[-1])
        self._still, self._axes = np.zeros(degrees), np.zeros((degrees, 3))

    def retained_state(self) -> tuple[()]:
        """Return nothing: no array is kept."""
        return ()

    def resume(self, begun: bool) -> None:
        """Do nothing: every frame is the first."""

    def set_moving(self, moving: Index) -> None:
        """Do nothing: this loop checks no body."""

    def follow(self, target: Target, dt: float) -> None:
        """Take the tracker's posture."""
        world = self.world
        for own, tracked in zip(world.posture, target.posture, strict=True):
            np.copyto(own, tracked)
        forward(world.geometry, world.skeleton, world.posture, self._still, world.poses, self._axes)

    def receive(self, impulses: Array) -> None:
        """Ignore impulses (nb, 3) [N s]: the tracker does not yield."""

    def passed(self, time: float) -> tuple[Snapshot, ...]:
        """Return nothing: there is one step."""
        return ()

    def counts(self) -> Tally:
        """Return no counts: there is no work worth counting."""
        return Tally()

    def statuses(self) -> dict[str, int]:
        """Return nothing: no step can fail."""
        return {}
