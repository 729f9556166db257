"""Our scene as PhysX actors: same shapes but for ellipsoids, same masses, exactly the scene's pairs; all in single precision.

An avatar's links are free bodies, held together by joints and led one by one: each by a soft drive to a kinematic actor of its
own, which is put where the tracker has the link.
"""

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import UnsupportedScene
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, Mass, Role
from avatarsim.scene.joint import LONGEST_SLIDE, Ball, Free, Hinge, Hinges, Rigid, Slide, SwingTwist, axes_of
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Shape, Sphere
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from reference.collision_groups import BITS, collision_groups
from reference.joint_angles import Joined
from reference.narrowing import hull_of
from reference.pair_factors import coefficients, fit_averages, weights
from reference.presets import Options
from reference.principal import principal_axes

with warnings.catch_warnings():
    # the package can draw, and warns on import where the system lacks its graphics libraries
    warnings.simplefilter("ignore")
    import sapien
    from sapien import physx

Array = NDArray[np.float64]
Pose = sapien.Pose

VERSION = f"{physx.version().rpartition('-')[2].partition('.patch')[0]} in sapien {sapien.__version__}"
"""Release of PhysX, without its branch and patch, and of the package."""

ARM = 1.0
"""Distance [m] from a joint to points by which further joints hold directions: a swing cone is two points 2 ARM sin(swing / 2)
apart at most, a hinge two points of its axis. Larger: rounding of positions counts more; smaller: that of directions."""
BETWEEN_HINGES = 0.1
"""Mass and inertia of a stand-in between hinges that share a centre, as a share of the link's. Smaller: joints converge worse."""
MAX_VERTICES = 129
"""Vertices of a hull, and of one that replaces an ellipsoid. The package thins larger ones, by up to 10 mm of 0.3 m."""
WHOLE_TURN = 2.0 * np.pi - 1e-3
"""Range of a hinge [rad] from which on it has no limits: angles wrap."""
X, CENTRE = (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)
LOCKS: Mapping[type, tuple[tuple[tuple[float, float, float], str], ...]] = {
    Ball: ((CENTRE, "xyz"),),
    Hinge: ((CENTRE, "xyz"), ((ARM, 0.0, 0.0), "yz")),
    Slide: ((CENTRE, "yz"), ((ARM, 0.0, 0.0), "yz"), ((0.0, ARM, 0.0), "z")),
    Rigid: ((CENTRE, "xyz"), ((ARM, 0.0, 0.0), "yz"), ((0.0, ARM, 0.0), "z")),
}
"""Points of a joint's frame and the axes along which they stay, per kind of joint, whose axis is x. Each is a joint of PhysX that
stays along axes only: the package leaves swings free, whatever their limits."""
STATED, TURN, PLACE, VELOCITY, SPIN = 13, slice(0, 4), slice(4, 7), slice(7, 10), slice(10, 13)
"""Numbers that the package packs of an actor: turn (w, x, y, z), place [m], velocity of its mass centre [m/s], spin [rad/s]."""


class World:
    """The actors of a scene at its first pose.

    moving (m,) bodies and links that are not fixed and rows (m,) of the values read of them; targets: a kinematic actor per
    link; joined: hinges and slides in the order of tracker angles, by rows, -1 for the world.
    """

    def __init__(self, scene: Scene, chosen: Options) -> None:
        self._scene, self._chosen = scene, chosen
        _set_globals(scene, chosen)
        self.system = physx.PhysxCpuSystem()
        self._stage = sapien.Scene([self.system])
        groups = collision_groups(scene.contact_filter)
        if groups is None:
            raise UnsupportedScene(f"pairs of scene {scene.name}", "more groups", f"{BITS} collision groups")
        self._places, self._turns = link_poses(scene.avatars, scene.first_sample)
        restitution, friction = (
            fit_averages(scene, wanted, matters).values.tolist()
            for wanted, matters in zip(coefficients(scene), weights(scene), strict=True)
        )
        self.actors = [self._body(body) for body in scene.bodies]
        self.actors += [self._link(k, link.mass, self._turns[k]) for k, link in enumerate(scene.links)]
        owners: list[Body | Link] = [*scene.bodies, *scene.links]
        for k, owner in enumerate(owners):
            material = physx.PhysxMaterial(friction[k], friction[k], restitution[k])
            rest = {Role.SIMULATED: "rest_offset", Role.DRIVEN: "driven_rest_offset"}.get(scene.roles[k])
            self._shapes(self.actors[k], owner, material, groups[k], chosen.number(rest) if rest else 0.0)
        self._axes, first = list[tuple[Any, Any, tuple[Array, Array, Hinge | Slide]]](), len(scene.bodies)
        for avatar in scene.avatars:
            self._join(avatar, first)
            first += len(avatar.links)
        for name, link in scene.attached:
            body, k = scene.names.index(name), scene.names.index(link)
            loose, holder = (Pose(actor.entity.pose.p, actor.entity.pose.q) for actor in (self.actors[body], self.actors[k]))
            _hold(Rigid, self.actors[body], self.actors[k], holder.inv() * loose, Pose())
        self.targets = [self._target(k) for k in range(len(scene.links))]
        row = {id(actor): k for k, actor in enumerate(self.system.rigid_dynamic_components)} | {id(None): -1}
        self.moving = np.array([k for k, role in enumerate(scene.roles) if role is not Role.FIXED], dtype=np.int64)
        self.rows = np.array([row[id(self.actors[k])] for k in self.moving], dtype=np.int64)
        self.joined = [Joined(row[id(above)], row[id(below)], *placed) for above, below, placed in self._axes]

    def read(self) -> Array:
        """Return numbers (actors, STATED) of all that is not fixed, targets too, and those of the world in the last row."""
        packed = np.frombuffer(self.system.pack(), dtype=np.float32).reshape(-1, STATED).astype(np.float64)
        packed[:, TURN] = rotation.normalised(packed[:, TURN])  # single precision is unit to seven digits only
        return np.vstack([packed, np.eye(1, STATED)])

    def _body(self, body: Body) -> Any:
        actor = self._actor(None if body.role is Role.FIXED else body.mass, body.position, body.orientation)
        if body.role is Role.SIMULATED:
            actor.linear_velocity, actor.angular_velocity = np.array(body.velocity), np.array(body.angular_velocity)
        return actor

    def _link(self, k: int, mass: Mass, turn: Array) -> Any:
        actor = self._actor(mass, self._places[k], turn)
        actor.disable_gravity = not self._chosen.flag("gravity_on_links")
        return actor

    def _actor(self, mass: Mass | None, place: Any, turn: Any) -> Any:
        """Add an actor without shapes at a pose; one without mass never moves."""
        actor = physx.PhysxRigidStaticComponent() if mass is None else physx.PhysxRigidDynamicComponent()
        if mass is not None:
            moments, axes = principal_axes(mass.inertia)
            actor.mass, actor.inertia, actor.cmass_local_pose = mass.mass, moments, Pose(np.array(mass.centre), axes)
            actor.linear_damping, actor.angular_damping = 0.0, self._chosen.number("angular_damping")
            actor.max_angular_velocity = self._chosen.number("max_angular_velocity")
            actor.sleep_threshold = self._chosen.number("sleep_threshold") if self._chosen.flag("sleep") else 0.0
            actor.solver_position_iterations = int(self._chosen.number("position_iterations"))
            actor.solver_velocity_iterations = int(self._chosen.number("velocity_iterations"))
        entity = sapien.Entity()
        entity.add_component(actor)
        entity.set_pose(Pose(np.array(place), np.array(turn)))
        self._stage.add_entity(entity)
        return actor

    def _shapes(self, actor: Any, owner: Body | Link, material: Any, group: tuple[int, int], rest: float) -> None:
        for piece in owner.pieces:
            shape, turned = _shape(piece.shape, material)
            shape.local_pose = Pose(np.array(piece.position), np.array(piece.orientation)) * turned
            shape.contact_offset, shape.rest_offset = self._chosen.number("contact_offset"), rest
            shape.set_collision_groups([*group, 0, 0])
            actor.attach(shape)

    def _target(self, k: int) -> Any:
        """Add a kinematic actor at link `k`, and the drive that holds the link to it."""
        actor = self._actor(Mass(1.0), self._places[k], self._turns[k])
        actor.kinematic = True
        frequency = self._chosen.number("drive_frequency")
        drive = _joint(physx.PhysxDriveComponent, self.actors[len(self._scene.bodies) + k], actor, Pose(), Pose())
        for axis in ("x", "y", "z", "slerp"):
            # per unit of mass and inertia, so that all links follow alike
            getattr(drive, f"set_drive_property_{axis}")(frequency**2, 2.0 * frequency, mode="acceleration")
        return actor

    def _join(self, avatar: Avatar, first: int) -> None:
        """Join the links of an avatar whose first is actor `first`."""
        index = {link.name: k for k, link in enumerate(avatar.links, start=first - len(self._scene.bodies))}
        links = self.actors[len(self._scene.bodies) :]
        for link in avatar.links:
            k, joint = index[link.name], link.joint
            below, above, turn = links[k], None, np.array(rotation.IDENTITY)
            if link.parent is not None:
                above, turn = links[index[link.parent]], self._turns[index[link.parent]]
            anchor, rest = np.array(link.anchor), np.array(link.orientation)
            if isinstance(joint, Ball):
                _ball(below, above, anchor, rest, joint.limits if self._scene.effects.limits else None)
            elif isinstance(joint, Hinges | Slide):
                *before, last = axes_of(joint)
                for axis in before:
                    turned = rotation.from_axis_angle(axis.axis, self._scene.first_sample.angles[len(self._axes)])
                    turn = rotation.multiply(rotation.multiply(turn, rest), turned)
                    share = Mass(BETWEEN_HINGES * link.mass.mass, link.mass.centre, BETWEEN_HINGES * link.mass.inertia)
                    between = self._link(k, share, turn)
                    self._axis(between, above, anchor, rest, axis)
                    above, anchor, rest = between, np.zeros(3), np.array(rotation.IDENTITY)
                self._axis(below, above, anchor, rest, last)
            elif not isinstance(joint, Free):
                _hold(Rigid, below, above, Pose(anchor, rest), Pose())

    def _axis(self, below: Any, above: Any, anchor: Array, rest: Array, axis: Hinge | Slide) -> None:
        """Join two actors by a hinge or a slide, the next of the tracker's angles."""
        slides, along, middle = isinstance(axis, Slide), rotation.between(X, axis.axis), 0.0
        limited = self._scene.effects.limits and axis.upper - axis.lower < (2.0 * LONGEST_SLIDE if slides else WHOLE_TURN)
        if limited and not slides:
            # counted from the middle of its range, an angle does not wrap before it is half a turn from it
            middle = 0.5 * (axis.lower + axis.upper)
        outer = rotation.multiply(rotation.multiply(rest, along), rotation.from_axis_angle(X, middle))
        joint = _hold(type(axis), below, above, Pose(anchor, outer), Pose(np.zeros(3), along))
        if limited:
            (joint.set_limit_x if slides else joint.set_limit_twist)(axis.lower - middle, axis.upper - middle)
        self._axes.append((above, below, (anchor, rest, axis)))


def _set_globals(scene: Scene, chosen: Options) -> None:
    """Set all globals of the process, whatever a run before left: the next system takes them."""
    config = physx.PhysxSceneConfig()
    config.gravity, config.bounce_threshold = np.array(scene.gravity), chosen.number("bounce_threshold")
    config.enable_tgs, config.enable_pcm = chosen.flag("tgs"), chosen.flag("pcm")
    physx.set_scene_config(config)


def _joint(kind: Any, below: Any, above: Any, outer: Any, inner: Any, locked: str = "") -> Any:
    """Add a joint of a kind of the package between two actors, the upper one None for the world."""
    joint = kind(below)
    if above is not None:
        joint.parent = above
    joint.pose_in_parent, joint.pose_in_child = outer, inner
    for axis in locked:
        getattr(joint, f"set_limit_{axis}")(0.0, 0.0)
    below.entity.add_component(joint)
    return joint


def _hold(kind: type, below: Any, above: Any, outer: Any, inner: Any) -> Any:
    """Join two actors, the frame `outer` of the upper one to `inner` of the lower; the joint at the frame's origin."""
    points = [(Pose(np.array(point)), locked) for point, locked in LOCKS[kind]]
    return [_joint(physx.PhysxDriveComponent, below, above, outer * at, inner * at, locked) for at, locked in points][0]


def _ball(below: Any, above: Any, anchor: Array, rest: Array, limits: SwingTwist | None) -> None:
    """Join by a ball; a limb at the middle of its limits has x of both frames along it, and twist is about x."""
    if limits is None:
        _hold(Ball, below, above, Pose(anchor, rest), Pose())
        return
    along = rotation.between(X, limits.axis)
    outer = rotation.multiply(rotation.between(limits.axis, limits.centre), along)
    _hold(Ball, below, above, Pose(anchor, outer), Pose(np.zeros(3), along)).set_limit_twist(*limits.twist)
    ends = Pose(anchor + ARM * np.array(limits.centre)), Pose(ARM * np.array(limits.axis))
    _joint(physx.PhysxDistanceJointComponent, below, above, *ends).set_limit(0.0, 2.0 * ARM * float(np.sin(0.5 * limits.swing)))


def _shape(shape: Shape, material: Any) -> tuple[Any, Any]:
    """Return a shape of the package and its pose in the frame of ours: its capsules lie along x."""
    if isinstance(shape, Sphere):
        return physx.PhysxCollisionShapeSphere(shape.radius, material), Pose()
    if isinstance(shape, Box):
        return physx.PhysxCollisionShapeBox(0.5 * np.array(shape.size), material), Pose()
    if isinstance(shape, Capsule):
        along = Pose(np.zeros(3), rotation.between(X, (0.0, 0.0, 1.0)))
        return physx.PhysxCollisionShapeCapsule(shape.radius, 0.5 * shape.length, material), along
    points = hull_of(shape, MAX_VERTICES).vertices
    # as large as 2 m along its own axes, and scaled back: vertices nearer than a thousandth of that become one
    axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2]
    axes[0] *= np.linalg.det(axes)
    low, high = (points @ axes.T).min(axis=0), (points @ axes.T).max(axis=0)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    mesh = physx.PhysxCollisionShapeConvexMesh(((points @ axes.T - middle) / half).astype(np.float32), half, material)
    return mesh, Pose(middle @ axes, rotation.from_matrix(axes.T))
