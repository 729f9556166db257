"""Our scene as a MuJoCo model: same shapes, vertices in single precision, same masses, exactly the scene's pairs."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Mass, Role
from avatarsim.scene.joint import LONGEST_SLIDE, MANY_TURNS, Ball, Free, Hinges, Rigid, Slide, SwingTwist, axes_of
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from reference.in_mujoco import three_hinges
from reference.in_mujoco.laws import Law, Laws
from reference.in_mujoco.motors import Servo, add_motor, damp_swings
from reference.in_mujoco.three_hinges import NARROWEST
from reference.principal import principal_axes

Indices = NDArray[np.int64]

ARM = 1.0
"""Length [m] from a ball joint to the two sites whose distance is the swing limit: chord 2 ARM sin(swing /
2)."""


@dataclass(frozen=True, eq=False)
class World:
    """The compiled model, its source, and where the scene's parts are in it.

    body_ids (n,) in canonical order; free (bodies, address in qpos, address in qvel) of simulated bodies; hinge_qpos (hinges,);
    balls (links, address in qpos); hinged likewise, of balls modelled by three hinges; roots likewise; mocap (welded links,) ->
    mocap index; geom_law, pair_law: the law that each geom and each explicit pair carries; geom_driven, pair_driven: whether
    an avatar has a part in it.
    """

    spec: mujoco.MjSpec
    model: mujoco.MjModel
    body_ids: Indices
    free: tuple[Indices, Indices, Indices]
    hinge_qpos: Indices
    balls: tuple[Indices, Indices]
    hinged: tuple[Indices, Indices]
    roots: tuple[Indices, Indices]
    mocap: tuple[Indices, Indices]
    geom_law: tuple[Law, ...]
    geom_driven: NDArray[np.bool_]
    pair_law: tuple[Law, ...]
    pair_driven: NDArray[np.bool_]


def build_world(scene: Scene, laws: Laws, limits: bool, swing: bool, gravity_on_links: bool, armature: float,
                servo: Servo | None = None, planes: bool = False, hinged: bool = False) -> World:
    """Compile the scene. Time steps and contact stiffness are set afterwards: they depend on the step.

    `limits`: hinge limits; `swing`: swing limits of ball joints, each as a tendon between two sites;
    `gravity_on_links`: whether the avatar weighs; `armature`: inertia added to each joint, as a share of the largest
    inertia of its link about it; `servo`: the servo in each joint, whose links are welded to the tracker if there is none;
    `planes`: fixed boxes are infinite planes at their tops, which is the same world where nothing leaves the top; `hinged`:
    ball joints with limits are three hinges.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.gravity = scene.gravity
    # exactly the scene's pairs: MuJoCo's own rule also drops grandparents across rigid joints
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
    # a diverged state must stay visible: by default it is silently replaced by the first one
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    geoms: list[list[str]] = []
    # avatars before the bodies they meet: MuJoCo eliminates velocities from the last to the first, and a lift that is eliminated
    # before the bodies on it leaves a full matrix of them all
    links = _avatars(spec, scene, laws, limits, swing, gravity_on_links, armature, servo, hinged)
    for k, body in enumerate(scene.bodies):
        made = spec.worldbody.add_body(name=f"b{k}", pos=body.position, quat=body.orientation)
        if body.role is Role.SIMULATED:
            made.add_freejoint(name=f"b{k}")
            _inertia(made, body)
        geoms.append(_geoms(spec, made, k, body.pieces, laws))
        if planes and body.role is Role.FIXED:
            _planes(made)
    geoms += links
    _attached(spec, scene)
    pairs = _pairs(spec, scene, laws, geoms)
    model = spec.compile()
    if servo is not None:
        damp_swings(model, servo)
    return _addresses(scene, laws, spec, model, geoms, pairs)


def _avatars(
    spec: mujoco.MjSpec, scene: Scene, laws: Laws, limits: bool, swing: bool, gravity: bool, armature: float,
    servo: Servo | None, hinged: bool,
) -> list[list[str]]:
    """Make all links; return the names of their geoms, link by link."""
    k, hinge, geoms = len(scene.bodies), 0, list[list[str]]()
    for avatar in scene.avatars:
        made: dict[str, mujoco.MjsBody] = {}
        for link in avatar.links:
            parent = spec.worldbody if link.parent is None else made[link.parent]
            body = parent.add_body(name=f"b{k}", pos=link.anchor, quat=link.orientation)
            made[link.name] = body
            body.gravcomp = 0.0 if gravity else 1.0
            _inertia(body, link)
            if isinstance(link.joint, Free):
                body.add_freejoint(name=f"b{k}")
            elif isinstance(link.joint, Ball) and hinged and link.joint.limits is not None:
                three_hinges.add(body, f"t{k}", link.joint.limits, limits, armature * _inertia_about_joint(link.mass))
                if swing and limits:
                    _swing_limit(spec, parent, body, k, link.anchor, link.joint.limits)
            elif isinstance(link.joint, Ball):
                ball = body.add_joint(name=f"b{k}", type=mujoco.mjtJoint.mjJNT_BALL)
                ball.armature = armature * _inertia_about_joint(link.mass)
                if servo is not None:
                    add_motor(spec, f"b{k}", True, servo)
                if swing and limits and link.joint.limits is not None:
                    _swing_limit(spec, parent, body, k, link.anchor, link.joint.limits)
            elif isinstance(link.joint, Hinges | Slide):
                slides = isinstance(link.joint, Slide)
                for stop in axes_of(link.joint):
                    kind = mujoco.mjtJoint.mjJNT_SLIDE if slides else mujoco.mjtJoint.mjJNT_HINGE
                    joint = body.add_joint(name=f"h{hinge}", type=kind, axis=stop.axis)
                    joint.armature = armature * (link.mass.mass if slides else _inertia_about_joint(link.mass))
                    most = LONGEST_SLIDE if slides else MANY_TURNS
                    free = stop.lower <= -most and stop.upper >= most
                    joint.limited = limits and not free
                    joint.range = [stop.lower, max(stop.upper, stop.lower + NARROWEST)]
                    if servo is not None:
                        add_motor(spec, f"h{hinge}", False, servo)
                    hinge += 1
            if isinstance(link.joint, Free) or (servo is None and not isinstance(link.joint, Rigid)):
                spec.worldbody.add_body(name=f"m{k}", mocap=True)
                weld = spec.add_equality(name=f"m{k}", type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY)
                weld.name1, weld.name2 = f"m{k}", f"b{k}"
                # anchor, relative position, relative orientation, weight of rotation against translation
                weld.data = [0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0]
            geoms.append(_geoms(spec, body, k, link.pieces, laws))
            k += 1
        for one in avatar.couplings:
            first, kind = hinge - avatar.hinge_count, mujoco.mjtEq.mjEQ_JOINT
            gear = spec.add_equality(name=f"g{first + one.follower}", type=kind, objtype=mujoco.mjtObj.mjOBJ_JOINT)
            gear.name1, gear.name2 = f"h{first + one.follower}", f"h{first + one.leader}"
            gear.data = [one.offset, one.ratio, *np.zeros(10)]
    return geoms


def _attached(spec: mujoco.MjSpec, scene: Scene) -> None:
    """Weld each attached body to its link, as the scene starts."""
    positions, orientations = link_poses(scene.avatars, scene.first_sample)
    for body, link in scene.attached:
        k, at = scene.names.index(link), scene.names.index(link) - len(scene.bodies)
        b = scene.names.index(body)
        back = rotation.conjugate(orientations[at])
        place = rotation.rotate(back, np.asarray(scene.bodies[b].position) - positions[at])
        turn = rotation.multiply(back, np.asarray(scene.bodies[b].orientation))
        weld = spec.add_equality(name=f"a{b}", type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY)
        weld.name1, weld.name2 = f"b{k}", f"b{b}"
        weld.data = [0, 0, 0, *place, *turn, 1, 0]


def _swing_limit(spec: mujoco.MjSpec, parent: mujoco.MjsBody, body: mujoco.MjsBody, k: int, anchor: tuple[float, ...],
                 limit: SwingTwist) -> None:
    """Add a circular cone as the longest distance of two points: one on the limb's axis, one on the cone's."""
    parent.add_site(name=f"centre{k}", pos=np.array(anchor) + ARM * np.array(limit.centre))
    body.add_site(name=f"axis{k}", pos=ARM * np.array(limit.axis))
    tendon = spec.add_tendon(name=f"swing{k}")
    tendon.wrap_site(f"centre{k}")
    tendon.wrap_site(f"axis{k}")
    tendon.limited = True
    tendon.range = [0.0, 2.0 * ARM * np.sin(0.5 * limit.swing)]


def _inertia_about_joint(mass: Mass) -> float:
    """Return the largest moment of inertia [kg m^2] of a link about the origin of its frame."""
    centre = np.array(mass.centre)
    shifted = mass.inertia + mass.mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return float(np.linalg.eigvalsh(shifted)[-1])


def _inertia(body: mujoco.MjsBody, owner: object) -> None:
    """Set mass, centre and principal inertia as stated."""
    mass = getattr(owner, "mass", None)
    assert isinstance(mass, Mass)
    moments, turn = principal_axes(mass.inertia)
    # MuJoCo refuses inertias that exceed the triangle inequality by a rounding error, as those of thin rods do
    largest = int(np.argmax(moments))
    moments[largest] = min(moments[largest], (moments.sum() - moments[largest]) * (1.0 - 1e-15))
    body.explicitinertial = True
    body.mass, body.ipos, body.inertia, body.iquat = mass.mass, mass.centre, moments, turn


def _geoms(spec: mujoco.MjSpec, body: mujoco.MjsBody, k: int, pieces: tuple[Piece, ...], laws: Laws) -> list[str]:
    names = []
    priority, law = laws.own[k]
    for i, piece in enumerate(pieces):
        geom = body.add_geom(name=f"g{k}.{i}", pos=piece.position, quat=piece.orientation)
        geom.priority, geom.friction, geom.condim = priority, [law.friction, 0.0, 0.0], _directions(law)
        shape = piece.shape
        if isinstance(shape, Sphere):
            geom.type, geom.size = mujoco.mjtGeom.mjGEOM_SPHERE, [shape.radius, 0.0, 0.0]
        elif isinstance(shape, Capsule):
            geom.type, geom.size = mujoco.mjtGeom.mjGEOM_CAPSULE, [shape.radius, 0.5 * shape.length, 0.0]
        elif isinstance(shape, Box):
            geom.type, geom.size = mujoco.mjtGeom.mjGEOM_BOX, 0.5 * np.array(shape.size)
        elif isinstance(shape, Ellipsoid):
            geom.type, geom.size = mujoco.mjtGeom.mjGEOM_ELLIPSOID, shape.radii
        else:
            geom.type, geom.meshname = mujoco.mjtGeom.mjGEOM_MESH, _mesh(spec, f"g{k}.{i}", shape)
        names.append(geom.name)
    return names


def _planes(body: mujoco.MjsBody) -> None:
    """Replace each box of a fixed body by the plane of its upper face; its size is the one that a viewer draws."""
    for geom in body.geoms:
        if geom.type == mujoco.mjtGeom.mjGEOM_BOX:
            wide, long, half = geom.size
            geom.pos = np.array(geom.pos) + rotation.rotate(np.array(geom.quat), (0.0, 0.0, half))
            geom.type, geom.size = mujoco.mjtGeom.mjGEOM_PLANE, [wide, long, 1.0]


def _mesh(spec: mujoco.MjSpec, name: str, shape: ConvexHull) -> str:
    """Return the hull of the vertices. MuJoCo moves a mesh to its centre of mass; its compiler moves the geom back."""
    mesh = spec.add_mesh(name=name)
    mesh.uservert = shape.vertices.astype(np.float32).ravel()
    # masses are stated: the mesh's own are not used, and this mode accepts the thinnest of hulls
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    return name


def _pairs(spec: mujoco.MjSpec, scene: Scene, laws: Laws, geoms: list[list[str]]) -> list[tuple[Law, bool]]:
    n, still = len(scene.names), np.array([role is Role.FIXED for role in scene.roles])
    for a in range(n):
        for b in range(a + 1, n):
            if not scene.contact_filter[a, b] and not (still[a] and still[b]):
                spec.add_exclude(bodyname1=f"b{a}", bodyname2=f"b{b}")
    made: list[tuple[Law, bool]] = []
    for (a, b), law in laws.explicit.items():
        for first in geoms[a]:
            for second in geoms[b]:
                pair = spec.add_pair(name=f"p{len(made)}", geomname1=first, geomname2=second)
                pair.condim, pair.friction = _directions(law), [law.friction, law.friction, 0.0, 0.0, 0.0]
                made.append((law, Role.DRIVEN in (scene.roles[a], scene.roles[b])))
    return made


def _directions(law: Law) -> int:
    """Return MuJoCo's condim: 1 is a contact without friction, 3 one with sliding friction."""
    return 3 if law.friction > 0.0 else 1


def _addresses(scene: Scene, laws: Laws, spec: mujoco.MjSpec, model: mujoco.MjModel, geoms: list[list[str]],
               pairs: list[tuple[Law, bool]]) -> World:
    def ints(values: list[int]) -> Indices:
        return np.array(values, dtype=np.int64)

    def qpos(name: str) -> int:
        return int(model.joint(name).qposadr[0])

    first = len(scene.bodies)
    moving = [k for k, body in enumerate(scene.bodies) if body.role is Role.SIMULATED]
    roots = [k for k, link in enumerate(scene.links) if isinstance(link.joint, Free)]
    named = {model.joint(j).name for j in range(model.njnt)}
    hinged = [k for k in range(len(scene.links)) if f"t{first + k}.0" in named]
    balls = [k for k, link in enumerate(scene.links) if isinstance(link.joint, Ball) and k not in hinged]
    mocap = {model.body(b).name: int(model.body_mocapid[b]) for b in range(model.nbody) if model.body_mocapid[b] >= 0}
    welded = [k for k in range(len(scene.links)) if f"m{first + k}" in mocap]
    owner = {name: k for k, names in enumerate(geoms) for name in names}
    owners = [owner[model.geom(g).name] for g in range(model.ngeom)]
    # the compiler sorts pairs: their names identify them
    order = [pairs[int(model.pair(p).name[1:])] for p in range(model.npair)]
    hinges = sum(avatar.hinge_count for avatar in scene.avatars)
    return World(
        spec=spec,
        model=model,
        body_ids=ints([model.body(f"b{k}").id for k in range(len(scene.names))]),
        free=(ints(moving), ints([qpos(f"b{k}") for k in moving]),
              ints([int(model.joint(f"b{k}").dofadr[0]) for k in moving])),
        hinge_qpos=ints([qpos(f"h{h}") for h in range(hinges)]),
        balls=(ints(balls), ints([qpos(f"b{first + k}") for k in balls])),
        hinged=(ints(hinged), ints([qpos(f"t{first + k}.0") for k in hinged])),
        roots=(ints(roots), ints([qpos(f"b{first + k}") for k in roots])),
        mocap=(ints(welded), ints([mocap[f"m{first + k}"] for k in welded])),
        geom_law=tuple(laws.own[k][1] for k in owners),
        geom_driven=np.array([scene.roles[k] is Role.DRIVEN for k in owners], dtype=bool),
        pair_law=tuple(law for law, _ in order),
        pair_driven=np.array([driven for _, driven in order], dtype=bool),
    )
