"""Our scene as a Rapier world: same shapes, same masses, exactly the scene's pairs, each link held to a target of its own."""

from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
import rapier3d as rapier
from numpy.typing import ArrayLike, NDArray

from avatarsim.scene.avatar import Link
from avatarsim.scene.body import Body, Mass, Role
from avatarsim.scene.joint import LONGEST_SLIDE, MANY_TURNS, Ball, Free, Hinge, Rigid, Slide, axes_of
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Shape, Sphere
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from reference.collision_groups import collision_groups
from reference.joint_angles import Joined
from reference.narrowing import hull_of
from reference.pair_factors import coefficients, fit, weights
from reference.presets import Options
from reference.principal import principal_axes

Array = NDArray[np.float64]
Handle = rapier.RigidBodyHandle
AnyJoint = rapier.GenericJoint | rapier.FixedJoint | rapier.SphericalJoint | rapier.RopeJoint
AXES = rapier.JointAxis
X = np.array((1.0, 0.0, 0.0))

ARM = 1.0
"""Length [m] from a ball joint to the two points whose distance is the swing limit: chord 2 ARM sin(swing / 2)."""
BETWEEN_HINGES = 1e-3
"""Mass and inertia of a stand-in between hinges that share a centre, as a share of the link's."""


@dataclass(eq=False)
class World:
    """The world, bodies in canonical order and after them those between hinges, (target, link) of the links held to targets, and
    all hinges and slides, in the order of the scene's angles.

    places (links, 3) [m], turned (links, 4), angles (hinges,) [rad, m]: the first posture;
    limits: flag, joints have them; reduced: flag, hinges and what is rigid are joined in reduced coordinates."""

    physics: rapier.PhysicsWorld
    places: Array
    turned: Array
    angles: Array
    limits: bool
    reduced: bool
    handles: list[Handle] = field(default_factory=list)
    held: list[tuple[Handle, int]] = field(default_factory=list)
    joined: list[Joined] = field(default_factory=list)

    def join(self, above: int, below: int, joint: AnyJoint, reduced: bool = False) -> None:
        """Insert a joint between two bodies, by their rows."""
        joints = self.physics.multibody_joints if reduced else self.physics.impulse_joints
        joints.insert(self.handles[above], self.handles[below], joint)

    def add(self, body: rapier.RigidBodyBuilder) -> int:
        """Insert a body without shape; return its row."""
        self.handles.append(self.physics.add_body(body, []))
        return len(self.handles) - 1


def build_world(scene: Scene, options: Options, unit: float) -> World:
    """Build the scene at its first posture, with skins in length units [m]. Settings of the solver are set afterwards."""
    world = World(rapier.PhysicsWorld(gravity=_vector(scene.gravity)), *link_poses(scene.avatars, scene.first_sample),
                  scene.first_sample.angles, scene.effects.limits, options.flag("reduced_coordinates"))
    groups = collision_groups(scene.contact_filter)
    factors = [fit(scene, wanted, matters).values for wanted, matters in zip(coefficients(scene), weights(scene), strict=True)]
    skins = {Role.DRIVEN: options.number("driven_skin"), Role.SIMULATED: options.number("loose_skin"), Role.FIXED: 0.0}
    owners: tuple[Body | Link, ...] = (*scene.bodies, *scene.links)
    for k, owner in enumerate(owners):
        colliders: list[rapier.Collider | rapier.ColliderBuilder] = []
        for piece in owner.pieces:
            collider = _collider(piece).restitution(float(factors[0][k])).friction(float(factors[1][k]))
            if groups is not None:
                own, others = groups[k]
                collider = collider.collision_groups(rapier.InteractionGroups(rapier.Group(own), rapier.Group(others)))
            colliders.append(collider.contact_skin(unit * skins[scene.roles[k]]))
        at = k - len(scene.bodies)
        pose = (owner.position, owner.orientation) if isinstance(owner, Body) else (world.places[at], world.turned[at])
        world.handles.append(world.physics.add_body(_body(owner, options).position(isometry(*pose)), colliders))
    if groups is None:
        _let_pass(world, scene)
    _join(world, scene, options)
    _attach(world, scene)
    return world


def isometry(position: ArrayLike, orientation: ArrayLike) -> rapier.Isometry3:
    """Return a pose in Rapier's form; `orientation` is (w, x, y, z)."""
    w, x, y, z = np.asarray(orientation, dtype=np.float64).tolist()
    return rapier.Isometry3(_vector(position), rapier.Rotation3(w, x, y, z))


def _vector(values: ArrayLike) -> tuple[float, float, float]:
    x, y, z = np.asarray(values, dtype=np.float64).tolist()
    return x, y, z


def _body(owner: Body | Link, options: Options) -> rapier.RigidBodyBuilder:
    """Return a body without place; rigid roots of avatars are fixed."""
    if owner.mass is None or (isinstance(owner, Link) and owner.parent is None and isinstance(owner.joint, Rigid)):
        return rapier.RigidBody.fixed()
    made = rapier.RigidBody.dynamic().gyroscopic_forces(True).ccd_enabled(options.flag("ccd"))
    made = made.additional_mass_properties(_mass(owner.mass))
    if isinstance(owner, Link):
        return made.can_sleep(False).gravity_scale(float(options.flag("gravity_on_links")))
    made = made.linvel(_vector(owner.velocity)).angvel(_vector(owner.angular_velocity))
    return made.can_sleep(options.flag("sleep"))


def _mass(mass: Mass, share: float = 1.0) -> rapier.MassProperties:
    moments, turn = principal_axes(mass.inertia)
    return rapier.MassProperties(_vector(mass.centre), share * mass.mass, _vector(share * moments), isometry(X, turn).rotation)


def _collider(piece: Piece) -> rapier.ColliderBuilder:
    """Return a piece without mass, for masses are stated; coefficients of two colliders are multiplied."""
    multiply = rapier.CoefficientCombineRule.MULTIPLY
    made = _shape(piece.shape).position(isometry(piece.position, piece.orientation)).density(0.0)
    return made.friction_combine_rule(multiply).restitution_combine_rule(multiply)


def _shape(shape: Shape) -> rapier.ColliderBuilder:
    if isinstance(shape, Sphere):
        return rapier.Collider.ball(shape.radius)
    if isinstance(shape, Capsule):
        half = 0.5 * shape.length
        return rapier.Collider.capsule_from_endpoints((0.0, 0.0, -half), (0.0, 0.0, half), shape.radius)
    if isinstance(shape, Box):
        return rapier.Collider.cuboid(*(0.5 * size for size in shape.size))
    return rapier.Collider.convex_hull(np.ascontiguousarray(hull_of(shape).vertices, dtype=np.float32))


def _let_pass(world: World, scene: Scene) -> None:
    """Let pairs pass by joints that hold nothing, where masks cannot express them."""
    for a, b in combinations(range(len(scene.names)), 2):
        fixed = scene.roles[a] is Role.FIXED and scene.roles[b] is Role.FIXED
        if not scene.contact_filter[a, b] and not fixed:
            world.join(a, b, rapier.GenericJointBuilder(rapier.JointAxesMask.empty()).contacts_enabled(False).build())


def _join(world: World, scene: Scene, options: Options) -> None:
    """Hold each link but a rigid root to a target of its own, and join it to its parent."""
    first = 0
    for avatar in scene.avatars:
        index = {link.name: first + k for k, link in enumerate(avatar.links)}
        for k, link in enumerate(avatar.links, start=first):
            row = len(scene.bodies) + k
            if link.parent is not None or not isinstance(link.joint, Rigid):
                # rigid links too: a spring per unit of mass leads its own link only
                pose = isometry(world.places[k], world.turned[k])
                target = world.physics.add_body(rapier.RigidBody.kinematic_position_based().position(pose), [])
                world.held.append((target, k))
                world.physics.impulse_joints.insert(target, world.handles[row], _spring(options))
            if link.parent is not None:
                above = index[link.parent]
                _joint(world, link, len(scene.bodies) + above, row, options, world.turned[above])
            elif not isinstance(link.joint, Free | Rigid):
                _joint(world, link, world.add(rapier.RigidBody.fixed()), row, options, np.array(rotation.IDENTITY))
        first += len(avatar.links)


def _spring(options: Options) -> rapier.GenericJoint:
    """Return six motors without joint: per unit of mass and inertia, so that all links follow alike."""
    frequency = options.number("weld_frequency")
    made = rapier.GenericJointBuilder(rapier.JointAxesMask.empty()).contacts_enabled(False)
    for axis in (AXES.LIN_X, AXES.LIN_Y, AXES.LIN_Z, AXES.ANG_X, AXES.ANG_Y, AXES.ANG_Z):
        made = made.motor_model(axis, rapier.MotorModel.ACCELERATION_BASED)
        made = made.motor_position(axis, 0.0, frequency**2, 2.0 * options.number("weld_damping_ratio") * frequency)
    return made.build()


def _joint(world: World, link: Link, above: int, row: int, options: Options, turned: Array) -> None:
    """Join a link to its parent `above`, which is `turned`."""
    anchor, rest = np.asarray(link.anchor), np.asarray(link.orientation)
    if isinstance(link.joint, Ball):
        _ball(world, link.joint, above, row, isometry(anchor, rest), options)
    elif not axes_of(link.joint):
        fixed = rapier.FixedJointBuilder().local_frame1(isometry(anchor, rest)).contacts_enabled(False).build()
        world.join(above, row, fixed, world.reduced)
    place = world.physics.rigid_bodies[world.handles[row]].position.translation
    for left, axis in reversed(list(enumerate(reversed(axes_of(link.joint))))):
        below = row
        if left:
            turned = rotation.multiply(turned, rest)
            turned = rotation.multiply(turned, rotation.from_axis_angle(axis.axis, world.angles[len(world.joined)]))
            between = rapier.RigidBody.dynamic().additional_mass_properties(_mass(link.mass, BETWEEN_HINGES))
            pose = isometry((place.x, place.y, place.z), turned)
            below = world.add(between.position(pose).can_sleep(False).gravity_scale(0.0))
        world.join(above, below, _about(axis, anchor, rest, world.limits), world.reduced)
        world.joined.append(Joined(above, below, anchor, rest, axis))
        above, anchor, rest = below, np.zeros(3), np.array(rotation.IDENTITY)


def _ball(world: World, ball: Ball, above: int, row: int, frame: rapier.Isometry3, options: Options) -> None:
    """Join by a spherical joint; a limb at the middle of its limits has x of both frames along it, and twist is about x."""
    made, limits = rapier.SphericalJointBuilder().contacts_enabled(False), ball.limits
    if limits is None or not world.limits:
        return world.join(above, row, made.local_frame1(frame).build())
    along, at = rotation.between(X, limits.axis), frame.translation
    anchor = np.array((at.x, at.y, at.z))
    made = made.local_frame1(isometry(anchor, rotation.multiply(rotation.between(limits.axis, limits.centre), along)))
    made = made.local_frame2(isometry(np.zeros(3), along)).limits(AXES.ANG_X, *limits.twist)
    if options["swing_limits"].value == "axes":
        made = made.limits(AXES.ANG_Y, -limits.swing, limits.swing).limits(AXES.ANG_Z, -limits.swing, limits.swing)
    if options["swing_limits"].value == "ropes":
        rope = rapier.RopeJointBuilder(2.0 * ARM * float(np.sin(0.5 * limits.swing))).contacts_enabled(False)
        rope = rope.local_anchor1(_vector(anchor + ARM * np.array(limits.centre)))
        world.join(above, row, rope.local_anchor2(_vector(ARM * np.array(limits.axis))).build())
    world.join(above, row, made.build())


def _about(axis: Hinge | Slide, anchor: Array, rest: Array, limits: bool) -> rapier.GenericJoint:
    """Return a hinge or a slide, with x of both frames along its axis."""
    slides, along = isinstance(axis, Slide), rotation.between(X, axis.axis)
    locked = rapier.JointAxesMask.LOCKED_PRISMATIC_AXES if slides else rapier.JointAxesMask.LOCKED_REVOLUTE_AXES
    made = rapier.GenericJointBuilder(locked).contacts_enabled(False)
    made = made.local_frame1(isometry(anchor, rotation.multiply(rest, along))).local_frame2(isometry(np.zeros(3), along))
    most = LONGEST_SLIDE if slides else MANY_TURNS
    if limits and not (axis.lower <= -most and axis.upper >= most):
        made = made.limits(AXES.LIN_X if slides else AXES.ANG_X, axis.lower, axis.upper)
    return made.build()


def _attach(world: World, scene: Scene) -> None:
    """Fix each attached body to its link, as the scene starts."""
    for name, link in scene.attached:
        k, b = scene.names.index(link), scene.names.index(name)
        at, body = k - len(scene.bodies), scene.bodies[b]
        back = rotation.conjugate(world.turned[at])
        place = rotation.rotate(back, np.asarray(body.position) - world.places[at])
        frame = isometry(place, rotation.multiply(back, body.orientation))
        world.join(k, b, rapier.FixedJointBuilder().local_frame1(frame).contacts_enabled(False).build())
