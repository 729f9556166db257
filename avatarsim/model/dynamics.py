"""Mass, inertia, pair coefficients and gravity as arrays; velocities of simulated bodies."""

from collections import Counter
from itertools import combinations_with_replacement
from typing import Annotated, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kept import BODY, BODY_OR_NONE, FLAG, NOT_KEPT, Whole
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Grid, IndexLine, Line, Matrices, Vectors
from avatarsim.model.couplings import elimination_parents
from avatarsim.model.geometry import OPEN, Poses
from avatarsim.model.skeleton import Posture, Skeleton, skeleton
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.spatial.vec3 import Vec3

Array = NDArray[np.float64]

FIXED, SIMULATED, DRIVEN = int(Role.FIXED.value), int(Role.SIMULATED.value), int(Role.DRIVEN.value)
"""Values of `Role`, as kernels read them."""


class Linkage(NamedTuple):
    """Joints of the avatars that the upper loop moves, of nl links and nd degrees of freedom.

    skeleton          of all avatars
    joints, user      posture of these avatars where the upper loop has them; of their trackers
    rate              (nd) how it changes: tangent velocity [rad/s], [m/s]; step (nd) in this substep
    bounds            (nd, 2) least and largest rate in this substep
    still             (nd) zeros
    above             (nd) the next degree towards the root, which moves all that this one moves; -1 at the root
    axes, axes_ahead  (nd, 3) of the degrees, world axes, at the start of the substep and at its end
    ahead             where links are at the end of the substep
    matrix, factor    (nd, most of an avatar) mass matrices of the avatars, columns from the first degree of each on; their
                      factors without the degrees that are at a limit
    at_limit          (nd) flag: at its limit
    free_momentum, momentum   (nd) of each degree without contact, and with it
    pushed, gained    (nd), (nd, 8) momentum and rate of each degree by one impulse; its rates per unit force and unit torque
    force, torque (nl, 3) working memory: force and torque at each link, or its velocities
    mass, moment, inertia   (nl), (nl, 3), (nl, 3, 3) of each link with all that it carries, about its joint
    """

    skeleton: Skeleton
    joints: Posture
    user: Posture
    rate: Line
    step: Line
    bounds: Grid
    still: Line
    above: IndexLine
    axes: Vectors
    axes_ahead: Vectors
    ahead: Poses
    matrix: Grid
    factor: Grid
    at_limit: IndexLine
    free_momentum: Line
    momentum: Line
    pushed: Line
    gained: Grid
    force: Vectors
    torque: Vectors
    mass: Line
    moment: Vectors
    inertia: Matrices


def make_linkage(scene: Scene) -> Linkage:
    """Allocate for the avatars of a scene."""
    skel = skeleton(scene)
    links, degrees, bodies = len(skel.kind), int(skel.first_dof[-1]), len(scene.names)
    roots = np.append(np.flatnonzero(skel.parent < 0), links)
    widest = int(np.diff(skel.first_dof[roots]).max(initial=0))

    def line() -> Array:
        return np.zeros(degrees)

    joints, user = (Posture(np.zeros((links, 3)), np.zeros((links, 3, 3)), line()) for _ in range(2))
    ahead = Poses(np.zeros((bodies, 3)), np.zeros((bodies, 3, 3)), np.zeros((0, 3)), np.zeros((0, 6)), np.zeros((0, 6)))
    return Linkage(
        skel, joints, user, line(), line(), np.zeros((degrees, 2)), line(), elimination_parents(skel), np.zeros((degrees, 3)),
        np.zeros((degrees, 3)),
        ahead, np.zeros((degrees, widest)), np.zeros((degrees, widest)), np.zeros(degrees, np.int64), line(), line(), line(),
        np.zeros((degrees, 8)), np.zeros((links, 3)), np.zeros((links, 3)), np.zeros(links),
        np.zeros((links, 3)), np.zeros((links, 3, 3)),
    )


PAUSE: Final = Whole(0, 1_000_000)
"""Frames of a pause: at most a second of frames of a microsecond."""


class DriveState(NamedTuple):
    """State of the virtual coupling of driven bodies that the upper loop moves while they are under load. nb bodies.

    Moving bodies are driven too: they are coupled unless they are at rest.

    linkage           their joints
    tied              (nb) body that leads the avatar of a body or of the link that it is attached to, else itself
    linked            (nb) flag: the body moves with all links of its avatar: that has joints, or carries something
    moves             (nb) flag: scenery that moves by itself
    blocked, blocked_turn   (nb) flags: the spring force, its torque was at its largest in the last substep
    carrier           (nb) body of the link that the body is attached to, -1 without
    attached_place, attached_turn   (nb, 3) [m], (nb, 3, 3) its pose in the frame of that link
    may_couple        (nb) flag: the upper loop can move the body
    coupled           (nb) flag: it does so in this frame
    loaded            (nb) flag: loose bodies pressed on it in the last frame
    unloaded          (nb) [s] time since they did
    position, turn    (nb, 3), (nb, 3, 3) where the tracker has the body at the end of the frame [m]
    paused, spread    (nb) frames for which its tracker has been at rest, and over which its last step is still to be spread
    linear, angular   (nb, 3) mean velocity of the tracker in this frame [m/s], [rad/s]
    gained, gained_turn   (nb, 3) by how much these grow in a frame, low-passed
    ramp, ramp_turn   (nb, 3) acceleration of the tracker within the frame [m/s^2], [rad/s^2]
    user, user_turn   (nb, 3) velocity of the tracker in this substep
    lag, lag_turn     (nb, 3) velocity of the body against the tracker [m/s], [rad/s]
    offset            (nb, 3) position against the tracker [m] of a rigid hand that an impact moved and that no body presses on
    mass, stiffness, damping   (nb) m [kg], K [N/m], R [N s/m] of eq. 6; nan until the engine's options set them
    largest_force     (nb) [N] of the spring
    fastest, fastest_turn   (nb) [m/s], [rad/s] at which a lag is made up
    """

    linkage: Annotated[Linkage, NOT_KEPT]
    tied: Annotated[IndexLine, BODY]
    linked: Annotated[IndexLine, FLAG]
    moves: Annotated[IndexLine, NOT_KEPT]
    blocked: Annotated[IndexLine, FLAG]
    blocked_turn: Annotated[IndexLine, FLAG]
    carrier: Annotated[IndexLine, BODY_OR_NONE]
    attached_place: Vectors
    attached_turn: Matrices
    may_couple: Annotated[IndexLine, NOT_KEPT]
    coupled: Annotated[IndexLine, FLAG]
    loaded: Annotated[IndexLine, FLAG]
    unloaded: Line
    position: Vectors
    turn: Matrices
    paused: Annotated[IndexLine, PAUSE]
    spread: Annotated[IndexLine, PAUSE]
    linear: Vectors
    angular: Vectors
    gained: Vectors
    gained_turn: Vectors
    ramp: Annotated[Vectors, NOT_KEPT]
    ramp_turn: Annotated[Vectors, NOT_KEPT]
    user: Annotated[Vectors, NOT_KEPT]
    user_turn: Annotated[Vectors, NOT_KEPT]
    lag: Vectors
    lag_turn: Vectors
    offset: Vectors
    mass: Annotated[Line, NOT_KEPT]
    stiffness: Annotated[Line, NOT_KEPT]
    damping: Annotated[Line, NOT_KEPT]
    largest_force: Annotated[Line, NOT_KEPT]
    fastest: Annotated[Line, NOT_KEPT]
    fastest_turn: Annotated[Line, NOT_KEPT]


def make_drive(scene: Scene, inverse_mass: Array) -> DriveState:
    """Allocate for the bodies of a scene, none of which couples yet."""
    law = np.tile([np.nan, np.nan, np.inf], (len(scene.names), 1))
    moves = np.zeros(len(scene.names), np.int64)
    b = len(scene.bodies)
    for avatar in scene.avatars:
        moves[b : b + len(avatar.links)] = int(avatar.moves)
        if avatar.drive is not None:
            law[b : b + len(avatar.links)] = avatar.drive.stiffness, avatar.drive.damping, avatar.drive.largest_force
        b += len(avatar.links)
    linkage, bodies = make_linkage(scene), len(scene.names)
    tied, first = np.arange(bodies, dtype=np.int64), linkage.skeleton.first
    for link, parent in enumerate(linkage.skeleton.parent.tolist()):
        if parent >= 0:
            tied[first + link] = tied[first + parent]

    def flags() -> NDArray[np.int64]:
        return np.zeros(bodies, np.int64)

    def vectors() -> Array:
        return np.zeros((bodies, 3))

    return DriveState(
        linkage=linkage, tied=tied, linked=flags(), moves=moves, blocked=flags(), blocked_turn=flags(),
        carrier=np.full(bodies, -1, np.int64), attached_place=vectors(), attached_turn=np.tile(np.eye(3), (bodies, 1, 1)),
        may_couple=flags(), coupled=flags(),
        loaded=flags(), unloaded=np.zeros(bodies), position=vectors(), turn=np.tile(np.eye(3), (bodies, 1, 1)), paused=flags(),
        spread=flags(),
        linear=vectors(), angular=vectors(), gained=vectors(), gained_turn=vectors(), ramp=vectors(), ramp_turn=vectors(),
        user=vectors(), user_turn=vectors(), lag=vectors(), lag_turn=vectors(), offset=vectors(),
        mass=np.divide(1.0, inverse_mass, out=np.zeros(bodies), where=inverse_mass > 0.0), stiffness=law[:, 0].copy(),
        damping=law[:, 1].copy(), largest_force=law[:, 2].copy(), fastest=np.full(bodies, np.inf),
        fastest_turn=np.full(bodies, np.inf),
    )


class Dynamics(NamedTuple):
    """Constants of the dynamics, and the driven bodies that the upper loop moves.

    role              (nb) int64, values of `Role`
    inverse_mass      (nb) [1/kg]; 0 for fixed and moving bodies, the inverse coupled mass for driven ones
    inertia           (nb, 3, 3) about the centre of mass, body axes [kg m^2]; zero unless simulated
    inverse_inertia   (nb, 3, 3)
    material          (nb) int64, number of the material of a body among the nm of the scene
    restitution, friction   (nm, nm) of pairs of materials; zero where no two bodies of theirs can meet
    gravity           (3) [m/s^2]
    surface           (nb, 3) [m/s] velocity of the surface, body axes
    drive             see `DriveState`
    """

    role: IndexLine
    inverse_mass: Line
    inertia: Matrices
    inverse_inertia: Matrices
    material: IndexLine
    restitution: Grid
    friction: Grid
    gravity: Line
    surface: Vectors
    drive: DriveState


class Velocities(NamedTuple):
    """linear (nb, 3) of the centre of mass [m/s] and angular (nb, 3) [rad/s], world axes."""

    linear: Vectors
    angular: Vectors


def dynamics(scene: Scene) -> Dynamics:
    """Return arrays of mass and material of `scene`; effects that it does not need are zero in them."""
    n = len(scene.names)
    inverse_mass, inertia, inverse_inertia = np.zeros(n), np.zeros((n, 3, 3)), np.zeros((n, 3, 3))
    for b, body in enumerate(scene.bodies):
        if body.role is Role.SIMULATED and body.mass is not None:
            inverse_mass[b] = 1.0 / body.mass.mass
            inertia[b] = body.mass.inertia
            inverse_inertia[b] = np.linalg.inv(body.mass.inertia)
    b = len(scene.bodies)
    for avatar in scene.avatars:
        for link in avatar.links:
            inverse_mass[b] = 1.0 / (avatar.coupled_mass if avatar.coupled_mass is not None else link.mass.mass)
            b += 1
    names = sorted(set(scene.material_names))
    number = {name: k for k, name in enumerate(names)}
    material = np.array([number[name] for name in scene.material_names], dtype=np.int64)
    restitution, friction = np.zeros((len(names), len(names))), np.zeros((len(names), len(names)))
    for x, y in meeting_materials(scene):
        pair = scene.materials.contact(x, y)
        i, k = number[x], number[y]
        restitution[i, k] = restitution[k, i] = pair.restitution if scene.effects.restitution else 0.0
        friction[i, k] = friction[k, i] = pair.friction if scene.effects.friction else 0.0
    role = np.array([r.value for r in scene.roles], dtype=np.int64)
    surface = np.zeros((n, 3))
    surface[len(scene.bodies) :] = np.array([link.surface_velocity for link in scene.links]).reshape(-1, 3)
    drive = make_drive(scene, inverse_mass)
    # moving bodies at rest do not yield
    inverse_mass[drive.moves == 1] = 0.0
    return Dynamics(
        role, inverse_mass, inertia, inverse_inertia, material, restitution, friction, np.array(scene.gravity), surface,
        drive,
    )


@kernel
def holder_of(drive: DriveState, b: int) -> int:
    """Return the link that body b is attached to, or b itself."""
    return int(drive.carrier[b] if drive.carrier[b] >= 0 else b)


@kernel
def gravity_on(dynamics: Dynamics, b: int) -> Vec3:
    """Return gravity [m/s^2] on body b: zero for driven bodies and bodies attached to them, whose weight their drives bear."""
    if dynamics.role[holder_of(dynamics.drive, b)] == DRIVEN:
        return (0.0, 0.0, 0.0)
    return (dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2])


def meeting_materials(scene: Scene) -> list[tuple[str, str]]:
    """Return the pairs of materials of which any two bodies may meet; only they need coefficients."""
    kinds = list(zip(scene.material_names, scene.families, strict=True))
    members = Counter(kinds)
    skipped = Counter(
        tuple(sorted((kinds[a], kinds[b]))) for a, b in {(min(pair), max(pair)) for pair in scene.skipped} if a != b
    )
    found = set()
    for one, other in combinations_with_replacement(sorted(members), 2):
        pairs = members[one] * (members[one] - 1) // 2 if one == other else members[one] * members[other]
        if (one[1] != other[1] or one[1] == OPEN) and pairs > skipped[one, other]:
            found.add((one[0], other[0]))
    return sorted(found)


def velocities(scene: Scene) -> Velocities:
    """Return the first velocities of every body; zero for fixed and driven ones."""
    n = len(scene.links)
    linear = [body.velocity for body in scene.bodies] + [(0.0, 0.0, 0.0)] * n
    angular = [body.angular_velocity for body in scene.bodies] + [(0.0, 0.0, 0.0)] * n
    return Velocities(np.array(linear, dtype=np.float64).reshape(-1, 3), np.array(angular, dtype=np.float64).reshape(-1, 3))
