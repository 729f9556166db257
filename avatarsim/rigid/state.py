"""State and working memory of the upper loop (Figure 3): allocated once per world, nothing while frames run.

Recorded events of a frame: the state of all bodies right before and right after each impact.

Events and steps of a frame, from the buffers of the two loops to snapshots that a recording keeps.
"""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.grid import SweepMemory, make_sweep_memory
from avatarsim.collision.manifold import Manifold, make_manifold
from avatarsim.collision.path import Paths, Series, make_paths, make_series
from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.engine import Snapshot
from avatarsim.jit.kept import FLAG, NOT_KEPT
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Cube, Grid, IndexGrid, IndexLine, Line, Matrices, Stack, Vectors
from avatarsim.model.conversion import write_shown
from avatarsim.model.dynamics import DriveState, Dynamics
from avatarsim.model.geometry import OPEN, Geometry, PairFilter, Poses
from avatarsim.model.world import World
from avatarsim.rigid.contacts import ROOM, ROOM_PER_BODY, Contacts, LastForces, Masses, make_contacts, make_last_forces, pace_of
from avatarsim.rigid.islands import Islands, make_islands
from avatarsim.rigid.near_pairs import DRIVEN_TOUCH, ROOM_TO_TOUCH, margin_for
from avatarsim.rigid.substep_state import Substeps, make_substeps
from avatarsim.scene.body import Role
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row
from avatarsim.tolerances import ROUNDING

Array = NDArray[np.float64]
Index = NDArray[np.int64]

APPROACH, IMPACT = 0, 1
"""Kind of an event: right before, and right after, at the same time."""


class Events(NamedTuple):
    """Events k < min(kept[0], cap) in order: time (cap) since the frame began at which the surfaces meet [s], kind, the pair
    whose impact it is (cap, 2); position (cap, nb, 3), rotation (cap, nb, 3, 3), linear, angular velocity (cap, nb, 3) of all.

    Poses are those at which the impact is resolved, with the stand-off still open. It takes the time gap / speed to close, so the
    last impact of a frame may be a few nanoseconds past its end, and slow impacts may overtake fast ones of other pairs."""

    used: IndexLine
    time: Line
    kind: IndexLine
    pair: IndexGrid
    position: Cube
    rotation: Stack
    linear: Cube
    angular: Cube


def make_events(bodies: int, cap: int = 64) -> Events:
    """Allocate room for ``cap`` events (two per impact) of so many bodies; cap 0 if nothing is recorded."""
    return Events(
        np.zeros(1, np.int64), np.zeros(cap), np.zeros(cap, np.int64), np.zeros((cap, 2), np.int64), np.zeros((cap, bodies, 3)),
        np.zeros((cap, bodies, 3, 3)), np.zeros((cap, bodies, 3)), np.zeros((cap, bodies, 3)),
    )


@kernel
def record(
    events: Events, kind: int, time: float, a: int, b: int, position: Array, rotation: Array, linear: Array, angular: Array
) -> None:
    """Append one event; the count increases when there is no room, so that the loss shows."""
    k = events.used[0]
    events.used[0] = k + 1
    if k >= events.time.shape[0]:
        return
    events.time[k], events.kind[k] = time, kind
    events.pair[k, 0], events.pair[k, 1] = a, b
    for body in range(position.shape[0]):
        put_row(events.position[k], body, row(position, body))
        put_columns(events.rotation[k], body, columns(rotation, body))
        put_row(events.linear[k], body, row(linear, body))
        put_row(events.angular[k], body, row(angular, body))


def snapshots(world: World, events: Events, begun: float) -> tuple[Snapshot, ...]:
    """Return one snapshot per recorded event; `begun` [s] is when the frame began."""
    used, names = [], world.scene.names
    for k in range(min(int(events.used[0]), len(events.time))):
        positions, orientations = np.empty_like(events.position[k]), np.empty((len(world.centres), 4))
        write_shown(events.position[k], events.rotation[k], world.centres, 0, positions, orientations)
        name = "approach" if events.kind[k] == APPROACH else "impact"
        linear, angular = events.linear[k].copy(), events.angular[k].copy()
        bodies = tuple(names[b] for b in sorted(events.pair[k].tolist()))
        used.append(Snapshot(begun + float(events.time[k]), positions, orientations, linear, angular, name, bodies))
    return tuple(used)


def trail_snapshots(world: World, trail: Array, time: float) -> tuple[Snapshot, ...]:
    """Return one snapshot, at `time` [s], per row of the trail (k, nl, 12) of a lower loop: positions [m] and rotations of links;
    all other bodies, and all velocities, as they are now."""
    first, used = world.skeleton.first, []
    for links in trail:
        position, rotation = world.poses.position.copy(), world.poses.rotation.copy()
        position[first:], rotation[first:] = links[:, :3], links[:, 3:].reshape(-1, 3, 3)
        positions, orientations = np.empty_like(position), np.empty((len(world.centres), 4))
        write_shown(position, rotation, world.centres, 0, positions, orientations)
        linear, angular = world.velocities.linear.copy(), world.velocities.angular.copy()
        used.append(Snapshot(time, positions, orientations, linear, angular))
    return tuple(used)


PAIRS_ROOM, PAIRS_PER_BODY = 65536, 32
"""Room for near pairs, or so many per body if that is more: a heap of a thousand has about ten thousand, a packed lattice 13 for
each. Fewer: motion is bounded over shorter horizons, each with a broad phase of its own, and a heap that has more pairs at rest
waits."""

CANDIDATES_MORE = 4
"""Room for so many times the number of bodies more candidates than pairs: see `collision.grid`."""

DONE, OUT_OF_SEGMENTS, OUT_OF_IMPACTS, OUT_OF_ROOM, SQUEEZED, NOT_FINITE = range(6)
"""Status of a frame: all of dt passed; the budget of segments is spent and bodies wait for the next frame where they were last
proved free; the budget of impacts is; more contacts or pairs than fit; overlap is left that no position of simulated bodies
removes; a pose or velocity is nan or infinite. Nothing overlaps and no energy is added in the first four."""

AGAIN = -1
"""Outcome of a step: no body was moved, and the step is to be repeated."""

STATUS_NAMES = ("done", "out of segments", "out of impacts", "out of room", "squeezed", "not finite")

(
    SEGMENTS, IMPACTS, GUARDED, AUDITED, SEARCHES, SOLVES, UNSOLVED, UNSQUEEZED, SWEEPS, CONTACTS, ISLANDS, SUBSTEPS, SHORTENED,
    WORK,
) = range(14)
"""Rows of `Memory.counts`: stretches between events, impacts, blocks shortened by the energy guard, segments whose energy gain
was taken back, time-of-impact searches, resting solves, those that missed their accuracy, position projections, broad phases,
most contacts of an island, most islands, substeps of crowds, bodies that went less than their motion in one, and work in units of
about a tenth of a microsecond."""

COUNT_NAMES = (
    "segments", "impacts", "impacts_guarded", "segments_audited", "impact_searches", "resting_solves", "resting_unsolved",
    "positions_corrected", "sweep_and_prune", "contacts", "islands", "substeps", "ways_shortened", "work",
)

WORK_CAP = 24000
"""Work of a frame after which islands end it by substeps, and of one stage of a solve: about two milliseconds. Fewer: calm scenes
lose the order of their impacts; more: frames in which a heap begins to move take longer."""

QUERY_WORK = 8
"""Work of one contact query."""

EVENTS_CAP = 100
"""Events of one island that are taken one after the other, before the rest is taken at once: segments of a frame, of which a
bouncing ball needs 2, a landing box 5 to 20, and each costs a contact solve; and, in addition to `response.IMPACTS_PER_POINT`,
impacts of an instant. Fewer: bodies lose time, and Newton's cradles speed; more: a struck stack takes thousands."""


class Switches(NamedTuple):
    """Effects that can be off. paper: eq. 10 unlimited and point by point, as printed; record: write impacts into the events."""

    gyroscopic: bool = True
    continuous: bool = True
    sleeping: bool = True
    paper: bool = False
    record: bool = False


class Memory(NamedTuple):
    """State of the upper loop from frame to frame, and working memory. nb bodies; flags are 0 or 1.

    received           (nb, 3) [N s] impulses that each driven body got in this frame, for eq. 6
    moving, asleep     (nb) flags: moves in this frame; left alone until something comes near
    ball, round        (nb) flags: one sphere about its centre of mass; spinning makes no torque on it
    supported          (nb) flags: has contact forces in this segment
    impact_masses      with driven bodies yielding, for impacts; masses: without, for forces
    inertia            (nb, 3, 3) [kg m^2] about the centres of mass, world axes
    reach, span        (nb) [m] largest distance of a vertex, of a point of the surface, from the centre of mass
    trial              poses used while searching for impacts; between frames those of the last frame
    paths, series      of the bodies in their last segment; working memory of their rotation
    contacts           of the island that is solved
    manifold, scratch  working memory of the narrow phase
    linear_end         (nb, 3) [m/s] velocities at the end of a segment, or before an impact
    angular_end        (nb, 3) [rad/s] the same
    before, direction  (contacts, 3) [N s] impulses before a sweep of the solver, and its direction of descent
    boxes              (nb, 6) [m] around the motion of bodies to the end of the frame: low x, y, z, high x, y, z
    wanted             pairs of bodies that may meet, those left out of driven ones that the lower loop alone moves
    sweep, pairs       working memory of the broad phase; (room, 2) near pairs
    a_rows, b_rows     (vertices, 6) of two pieces, bounds of the motion of each vertex: see `collision.motion_bounds`
    last               forces of the last segment
    counts             work done in this frame: see `COUNT_NAMES`
    owed_linear        (nb, 3) [m/s] velocities that bodies get back: see `rigid.deferred_impacts`
    owed_angular       (nb, 3) [rad/s] the same
    owing              (1) flag: whether there are any
    began              poses at the start of each body's last segment
    islands            and their clocks
    joins              (nb) flags: connects islands, since it is moving or driven
    corrected          (nb) [s] since the frame began at which the last position projection was, -1 before it
    all_bodies         (nb) their numbers, from 0 on
    edges              (2, 6) working memory of `collision.edge_edge`
    tail_end           (nb) [s] since the frame began at which the last bounces of a ball end, -1 without: see `rigid.impacts`
    tail_speed         (nb, 3) [m/s] its velocity until then
    newest, older      (nb), (contacts, 2) contacts of a body one after the other: see `rigid.internal_edges`, `rigid.impacts`
    margin             (1) [m] by which boxes of the broad phase are larger: see `rigid.near_pairs`
    touch              (1) [m] gap below which a driven body has contacts
    shown_linear       (nb, 3) [m/s] velocities of the displayed motion of driven bodies
    shown_angular      (nb, 3) [rad/s] the same
    substeps           state and scratch of certified substeps
    horizon            (1) [s] for which motion is bounded at most in this frame; 0 once the pairs have no room for any time
    """

    received: Vectors
    moving: Annotated[IndexLine, FLAG]
    asleep: Annotated[IndexLine, FLAG]
    ball: Annotated[IndexLine, NOT_KEPT]
    round: Annotated[IndexLine, NOT_KEPT]
    supported: Annotated[IndexLine, FLAG]
    impact_masses: Masses
    masses: Masses
    inertia: Matrices
    reach: Annotated[Line, NOT_KEPT]
    span: Annotated[Line, NOT_KEPT]
    trial: Poses
    paths: Paths
    series: Annotated[Series, NOT_KEPT]
    contacts: Annotated[Contacts, NOT_KEPT]
    manifold: Annotated[Manifold, NOT_KEPT]
    scratch: Annotated[Scratch, NOT_KEPT]
    linear_end: Vectors
    angular_end: Vectors
    before: Annotated[Vectors, NOT_KEPT]
    direction: Annotated[Vectors, NOT_KEPT]
    boxes: Annotated[Grid, NOT_KEPT]
    wanted: Annotated[PairFilter, NOT_KEPT]
    sweep: Annotated[SweepMemory, NOT_KEPT]
    pairs: Annotated[IndexGrid, NOT_KEPT]
    a_rows: Annotated[Grid, NOT_KEPT]
    b_rows: Annotated[Grid, NOT_KEPT]
    last: LastForces
    counts: Annotated[IndexLine, NOT_KEPT]
    owed_linear: Vectors
    owed_angular: Vectors
    owing: Annotated[IndexLine, FLAG]
    began: Poses
    islands: Islands
    joins: Annotated[IndexLine, FLAG]
    corrected: Line
    all_bodies: Annotated[IndexLine, NOT_KEPT]
    edges: Annotated[Grid, NOT_KEPT]
    tail_end: Line
    tail_speed: Vectors
    newest: Annotated[IndexLine, NOT_KEPT]
    older: Annotated[IndexGrid, NOT_KEPT]
    margin: Annotated[Line, NOT_KEPT]
    touch: Annotated[Line, NOT_KEPT]
    shown_linear: Vectors
    shown_angular: Vectors
    substeps: Annotated[Substeps, NOT_KEPT]
    horizon: Annotated[Line, NOT_KEPT]


def most_links(drive: DriveState) -> int:
    """Return the number of links of the largest avatar that the upper loop may move; 0 if there is none."""
    movable = drive.tied[drive.may_couple == 1]
    return int(np.bincount(movable).max(initial=0))


def make_memory(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, gyroscopic: bool = True, stand_off: float = 0.0
) -> Memory:
    """Allocate for a world whose bodies are at ``poses``; driven ones keep ``stand_off`` [m] from everything."""
    n = len(dynamics.role)
    simulated = dynamics.role == Role.SIMULATED.value
    moments = np.linalg.eigvalsh(dynamics.inertia)
    # with equal principal moments spinning about any axis is free of torque
    round_ = np.array([not gyroscopic or np.ptp(m) <= ROUNDING * m.max() for m in moments], np.int64)
    reach, span, ball = np.zeros(n), np.zeros(n), np.zeros(n, np.int64)
    shapes = geometry.shapes
    for b in range(n):
        pieces = range(geometry.first_shape[b], geometry.first_shape[b + 1])
        for s in pieces:
            points = geometry.local[shapes.start[s] : shapes.start[s + 1]]
            if shapes.kind[s] == 1:
                far = float(np.linalg.norm(points[0]) + np.linalg.norm(points[1:], axis=1).max())
            else:
                far = float(np.linalg.norm(points, axis=1).max())
            reach[b], span[b] = max(reach[b], far), max(span[b], far + shapes.radius[s])
        only = pieces[0] if len(pieces) == 1 else -1
        if only >= 0 and shapes.kind[only] == 0 and shapes.start[only + 1] - shapes.start[only] == 1:
            ball[b] = int(reach[b] <= ROUNDING * span[b])
    inverse_inertia = np.zeros((n, 3, 3))
    inverse_mass = dynamics.inverse_mass
    # without the gyroscopic effect a tumbling body just keeps its angular velocity
    most = int(np.diff(shapes.start).max()) if len(geometry.body) else 1
    room = min(max(PAIRS_ROOM, PAIRS_PER_BODY * n), max(1, n * (n - 1) // 2))
    touch, driven = max(DRIVEN_TOUCH, 2.0 * stand_off), bool((dynamics.role == Role.DRIVEN.value).any())
    touching = max(ROOM, ROOM_PER_BODY * int(simulated.sum()))
    return Memory(
        received=np.zeros((n, 3)), moving=np.zeros(n, np.int64), asleep=np.zeros(n, np.int64), ball=ball, round=round_,
        supported=np.zeros(n, np.int64), impact_masses=Masses(inverse_mass.copy(), inverse_inertia),
        masses=Masses(np.where(simulated, inverse_mass, 0.0), inverse_inertia), inertia=np.zeros((n, 3, 3)), reach=reach,
        span=span, trial=Poses(*(field.copy() for field in poses)),
        paths=make_paths(dynamics.inertia.copy(), dynamics.inverse_inertia.copy(), round_), series=make_series(),
        contacts=make_contacts(
            touching, pace_of(dynamics.gravity), n, len(dynamics.drive.linkage.skeleton.kind), most_links(dynamics.drive)
        ),
        manifold=make_manifold(), scratch=make_scratch(),
        linear_end=np.zeros((n, 3)),
        angular_end=np.zeros((n, 3)), before=np.zeros((touching, 3)), direction=np.zeros((touching, 3)), boxes=np.zeros((n, 6)),
        wanted=geometry.wanted._replace(
            family=np.where(simulated | (dynamics.drive.may_couple > dynamics.drive.moves), OPEN, 0)
        ),
        sweep=make_sweep_memory(n, room + CANDIDATES_MORE * n),
        pairs=np.zeros((room, 2), np.int64), a_rows=np.zeros((most, 6)), b_rows=np.zeros((most, 6)),
        last=make_last_forces(n, touching), counts=np.zeros(len(COUNT_NAMES), np.int64),
        owed_linear=np.zeros((n, 3)), owed_angular=np.zeros((n, 3)), owing=np.zeros(1, np.int64),
        began=Poses(*(field.copy() for field in poses)), islands=make_islands(n, room), joins=np.zeros(n, np.int64),
        corrected=np.zeros(n), all_bodies=np.arange(n, dtype=np.int64),
        edges=np.zeros((2, 6)), tail_end=np.full(n, -1.0), tail_speed=np.zeros((n, 3)),
        newest=np.full(n, -1, np.int64), older=np.full((touching, 2), -1, np.int64),
        margin=np.full(1, max(margin_for(span, simulated, driven), ROOM_TO_TOUCH * touch if driven else 0.0)),
        touch=np.full(1, touch),
        shown_linear=np.zeros((n, 3)), shown_angular=np.zeros((n, 3)),
        substeps=make_substeps(n, poses, room, touching), horizon=np.zeros(1),
    )
