"""The whole world as arrays: what never changes, and the state that the stages write."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses
from avatarsim.spatial import rotation
from avatarsim.world.dynamics import Dynamics, Velocities, dynamics, velocities
from avatarsim.world.geometry import Geometry, Poses, geometry, poses
from avatarsim.world.skeleton import Posture, Skeleton, hinge_dofs, skeleton

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class World:
    """Arrays built once from a scene. `centres` (nb, 3) are centres of mass in body frames, the origin of simulated bodies;
    `hinges` the degree of freedom of every hinge angle in a TrackerSample."""

    scene: Scene
    geometry: Geometry
    skeleton: Skeleton
    dynamics: Dynamics
    poses: Poses
    velocities: Velocities
    posture: Posture
    centres: Array
    hinges: NDArray[np.int64]


def posture_of(skel: Skeleton, hinges: NDArray[np.int64], sample: TrackerSample) -> Posture:
    """The sample as arrays for the kernels."""
    angle = np.zeros(skel.first_dof[-1])
    angle[hinges] = sample.angles
    root = np.array(sample.positions, dtype=np.float64).reshape(-1, 3)
    turn = np.ascontiguousarray(rotation.to_matrix(rotation.normalised(sample.rotations))).reshape(-1, 3, 3)
    return Posture(root, turn, angle)


def build(scene: Scene) -> World:
    """The world of `scene` at its first poses."""
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
    return World(scene, geo, skel, dynamics(scene), placed, velocities(scene), posture, centres, hinges)


def shown_poses(world: World, position: Array, matrices: Array) -> tuple[Array, Array]:
    """Positions and orientations of body frames, from centres of mass and rotation matrices."""
    orientation = rotation.from_matrix(matrices).reshape(-1, 4)
    return position - rotation.rotate(orientation, world.centres), orientation
