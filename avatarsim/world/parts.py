"""Layout of the arenas of a world and of a target: see `jit.arena`."""

from typing import NamedTuple

from avatarsim.jit.layout import IndexLine
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton


class WorldParts(NamedTuple):
    """Arrays of a world."""

    geometry: Geometry
    dynamics: Dynamics
    poses: Poses
    velocities: Velocities
    skeleton: Skeleton
    posture: Posture


class TargetParts(NamedTuple):
    """The tracker's posture of this frame; one to read a sample into; the degree of freedom of every hinge angle in a sample."""

    posture: Posture
    incoming: Posture
    hinges: IndexLine
