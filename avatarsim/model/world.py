"""World: all arrays of a scene, the constant model and the state that the stages of a frame write.

Layout of the arenas of a world and of a target: see `jit.arena`.

Target posture of a frame: the tracker sample as arrays, checked as it is read.
"""

from dataclasses import dataclass
from math import isfinite
from typing import Annotated, ClassVar, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import AvatarsimError, InvalidSample
from avatarsim.jit.arena import pack, view_arena
from avatarsim.jit.kept import NOT_KEPT
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Index, IndexLine
from avatarsim.model.conversion import read_sample, write_sample, write_shown
from avatarsim.model.dynamics import DriveState, Dynamics, Velocities, dynamics, velocities
from avatarsim.model.geometry import Geometry, Poses, geometry, poses
from avatarsim.model.skeleton import Posture, Skeleton, hinge_dofs, skeleton
from avatarsim.scene.body import Role
from avatarsim.scene.checks import as_number, real_array
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked, link_poses
from avatarsim.spatial import rotation


class WorldParts(NamedTuple):
    """Arrays of a world."""

    geometry: Geometry
    dynamics: Dynamics
    poses: Poses
    velocities: Velocities
    skeleton: Skeleton
    posture: Posture


class WorldState(NamedTuple):
    """Arrays of a world that pass from frame to frame."""

    poses: Poses
    velocities: Velocities
    posture: Posture
    drive: DriveState


class TargetParts(NamedTuple):
    """The tracker's posture of this frame; one to read a sample into; the degree of freedom of every hinge angle in a sample."""

    posture: Posture
    incoming: Annotated[Posture, NOT_KEPT]
    hinges: Annotated[IndexLine, NOT_KEPT]


Array = NDArray[np.float64]

FLOAT64: Final = np.dtype(np.float64)
"""The one that nearly all arrays of that kind carry; the others are copied."""


@dataclass(frozen=True, eq=False)
class World:
    """Arrays built once from a scene; `words` is the arena that the next six are views of.

    `centres` (nb, 3) are centres of mass in body frames, the origin of simulated bodies; `hinges` the degree of freedom of every
    hinge angle in a TrackerSample.
    """

    ASSIGNED: ClassVar[tuple[str, ...]] = ()
    WRITTEN: ClassVar[tuple[str, ...]] = ("words",)

    scene: Scene
    words: NDArray[np.int64]
    geometry: Geometry
    skeleton: Skeleton
    dynamics: Dynamics
    poses: Poses
    velocities: Velocities
    posture: Posture
    centres: Array
    hinges: NDArray[np.int64]

    @property
    def drive(self) -> DriveState:
        """Return driven bodies that the upper loop moves."""
        return self.dynamics.drive

    def link_friction(self) -> tuple[NDArray[np.int64], Array]:
        """Return the material of each link and fixed body (nb), -1 of loose bodies, and the coefficients of pairs (nm, nm)."""
        masses = self.dynamics
        return np.where(masses.role == Role.SIMULATED.value, -1, masses.material), masses.friction.copy()

    def retained_state(self) -> WorldState:
        """Return what passes from frame to frame."""
        return WorldState(self.poses, self.velocities, self.posture, self.drive)


def posture_of(skel: Skeleton, hinges: NDArray[np.int64], sample: TrackerSample) -> Posture:
    """Return the sample as arrays for the kernels; the sample has been checked."""
    nl = len(skel.kind)
    posture = Posture(np.zeros((nl, 3)), np.zeros((nl, 3, 3)), np.zeros(skel.first_dof[-1]))
    read_sample(*sample_arrays(sample), hinges, posture)
    return posture


def sample_arrays(sample: TrackerSample) -> tuple[Array, Array, Array]:
    """Return positions, rotations and angles as the kernels take them: float64, C-contiguous, writeable."""
    return _ready(sample.positions), _ready(sample.rotations), _ready(sample.angles)


def _ready(array: Array) -> Array:
    # np.require takes three times as long
    if type(array) is np.ndarray and array.dtype is FLOAT64 and array.flags.carray:
        return array
    return np.require(real_array(array), np.float64, ["C", "W"])


def build(scene: Scene) -> World:
    """Return the world of `scene` at its first poses."""
    geo, skel = geometry(scene), skeleton(scene)
    hinges = hinge_dofs(skel)
    link_position, link_orientation = link_poses(scene.avatars, scene.first_sample)
    centres = np.zeros((len(scene.names), 3))
    for b, body in enumerate(scene.bodies):
        if body.role is Role.SIMULATED and body.mass is not None:
            centres[b] = body.mass.centre
    position = np.vstack([np.array([body.position for body in scene.bodies], dtype=np.float64).reshape(-1, 3), link_position])
    orientation = np.vstack(
        [np.array([body.orientation for body in scene.bodies], dtype=np.float64).reshape(-1, 4), link_orientation]
    )
    placed = poses(geo, position + rotation.rotate(orientation, centres), orientation)
    posture = posture_of(skel, hinges, scene.first_sample)
    words, (geo, masses, placed, speeds, skel, posture) = pack(
        WorldParts(geo, dynamics(scene), placed, velocities(scene), skel, posture)
    )
    return World(scene, words, geo, skel, masses, placed, speeds, posture, centres, hinges)


NOT_FINITE_POSE = "a pose of the engine's own is not finite: this is a defect, please report it with the scene"
"""Message of the error for a state that cannot be shown."""


def shown_poses(world: World) -> tuple[Array, Array]:
    """Return positions (n, 3) and orientations (n, 4) of body frames now. Raises AvatarsimError if a number is not finite."""
    n = len(world.centres)
    position, orientation = np.empty((n, 3)), np.empty((n, 4))
    if not write_shown(world.poses.position, world.poses.rotation, world.centres, 0, position, orientation):
        raise AvatarsimError(NOT_FINITE_POSE)
    return position, orientation


@kernel
def read_opened(positions: Array, rotations: Array, angles: Array, target: Index) -> bool:
    """Run `read_sample` on the arena of a target: a good sample becomes its posture, a bad one is forgotten."""
    parts = view_arena(target, TargetParts)
    if not read_sample(positions, rotations, angles, parts.hinges, parts.incoming):
        return False
    return read_sample(positions, rotations, angles, parts.hinges, parts.posture)


@kernel
def write_opened(world: Index, hinges: Index, positions_out: Array, rotations_out: Array, angles_out: Array) -> None:
    """Run `write_sample` for the posture in the arena of a world."""
    write_sample(view_arena(world, WorldParts).posture, hinges, positions_out, rotations_out, angles_out)


def shown_sample(world: World, time: float) -> TrackerSample:
    """Return the posture that is shown, as a tracker would report it at `time` [s]: a copy."""
    links = len(world.posture.root)
    arrays = np.empty((links, 3)), np.empty((links, 4)), np.empty(len(world.hinges))
    write_opened(world.words, world.hinges, *arrays)
    return TrackerSample(time, *arrays)


class Target:
    """The latest tracker sample. A bad one raises InvalidSample and leaves the last good one in place."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ()
    WRITTEN: ClassVar[tuple[str, ...]] = ("words",)

    def __init__(self, world: World) -> None:
        self.world = world
        first = posture_of(world.skeleton, world.hinges, world.scene.first_sample)
        incoming = Posture(*(array.copy() for array in first))
        self.words, self._parts = pack(TargetParts(first, incoming, world.hinges))
        self.posture = self._parts.posture
        self._shapes = self.posture.root.shape, (len(self.posture.root), 4), world.hinges.shape

    def retained_state(self) -> TargetParts:
        """Return the posture that passes from frame to frame."""
        return self._parts

    def read(self, sample: TrackerSample) -> None:
        """Check the sample and copy it."""
        try:
            positions, rotations, angles = sample_arrays(sample)
        except (AttributeError, TypeError, ValueError) as error:
            checked(sample, self.world.scene.avatars)
            raise InvalidSample("tracker sample", sample, "a TrackerSample of numbers") from error
        time, fits = sample.time, (positions.shape, rotations.shape, angles.shape) == self._shapes
        good = fits and isfinite(time if type(time) is float else as_number(time))
        if not (good and read_opened(positions, rotations, angles, self.words)):
            # the slow check finds which value is wrong, for the message
            checked(sample, self.world.scene.avatars)
            raise InvalidSample("tracker sample", sample, "finite, and quaternions of length 1")
