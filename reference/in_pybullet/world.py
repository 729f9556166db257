"""Our scene as Bullet multibodies: same shapes but for stand-ins, same masses, exactly the scene's pairs.

Bullet knows inertias along the axes of a link's frame only, so each link's frame is turned to its principal
axes here (`Part.frame`), and joints, anchors and shapes with it. Results are turned back.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import combinations, product
from typing import Any

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, Mass, Role, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import LONGEST_SLIDE, MANY_TURNS, Ball, Free, Hinges, Rigid, Slide, SwingTwist, axes_of
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import link_poses
from avatarsim.spatial import rotation
from reference.in_pybullet import urdf
from reference.in_pybullet.shapes import IDENTITY, Placed, collision_shape, parted, placed, xyzw
from reference.principal import principal_axes

Array = NDArray[np.float64]

BETWEEN_HINGES = 1e-3
"""Mass and inertia of the stand-in links between hinges that share a centre, relative to their link's. Bullet
has one joint per link, and a link without mass divides by zero when axes line up."""


@dataclass(frozen=True, eq=False)
class Part:
    """Where a body or link is in Bullet: multibody, link index (-1: base), its frame against ours, its mass
    centre (ours); `shapes`: the links that carry its pieces; `also`: fixed multibodies that carry those beyond the first."""

    body: int
    link: int
    frame: Array
    centre: Array
    shapes: tuple[int, ...] = (-1,)
    also: tuple[int, ...] = ()

    @property
    def carriers(self) -> tuple[tuple[int, int], ...]:
        """(multibody, link) of all parts that carry its pieces."""
        return (*((self.body, link) for link in self.shapes), *((body, -1) for body in self.also))


@dataclass(eq=False)
class World:
    """All parts in canonical order; joints to drive.

    hinges [(multibody, joint)] of hinges and slides in the order of tracker angles; balls [(multibody, joint, link of the
    scene)]; roots [(part, link of the scene)]; lefts: link of a ball -> left, where Bullet states a turn of ours as left turn
    frame; maximal: simulated bodies outside the multibody solver.
    """

    client: int
    parts: list[Part] = field(default_factory=list)
    hinges: list[tuple[int, int]] = field(default_factory=list)
    balls: list[tuple[int, int, int]] = field(default_factory=list)
    roots: list[tuple[int, int]] = field(default_factory=list)
    lefts: dict[int, Array] = field(default_factory=dict)
    maximal: set[int] = field(default_factory=set)


def build_world(scene: Scene, client: int, maximal: bool, limits: bool, ball_limits: bool, hulls: bool,
                apart: bool) -> World:
    """Make all bodies at their first pose. `maximal`: simulated bodies of simple inertia outside the multibody solver; `limits`:
    those of hinges, with `ball_limits` of ball joints too; `hulls`: boxes of links as hulls; `apart`: each of several pieces of a
    driven link on a link of its own, without mass."""
    world = World(client)
    for k, body in enumerate(scene.bodies):
        # a bounce between two solvers is the multibody solver's: fixed bodies go with the simulated ones
        simple = maximal and _is_simple(body)
        world.parts.append(_body(body, client, simple or (maximal and body.role is Role.FIXED)))
        if simple:
            world.maximal.add(k)
    first = 0
    for avatar in scene.avatars:
        _avatar(world, scene, avatar, first, limits, limits and ball_limits, _Chain(hulls, apart))
        first += len(avatar.links)
    _filter(world, scene)
    _attach(world, scene)
    return world


def _attach(world: World, scene: Scene) -> None:
    """Fix each attached body to its link by a constraint, as the scene starts."""
    positions, orientations = link_poses(scene.avatars, scene.first_sample)
    for body, link in scene.attached:
        at, b = scene.names.index(link) - len(scene.bodies), scene.names.index(body)
        parent, child, loose = world.parts[scene.names.index(link)], world.parts[b], scene.bodies[b]
        turn, own = orientations[at], np.asarray(loose.orientation)
        place = np.asarray(loose.position) + rotation.rotate(own, child.centre)
        frame = rotation.multiply(turn, parent.frame)
        back = rotation.conjugate(frame)
        away = rotation.rotate(back, place - positions[at] - rotation.rotate(turn, parent.centre))
        turned = rotation.multiply(back, rotation.multiply(own, child.frame))
        pybullet.createConstraint(
            parent.body, parent.link, child.body, child.link, pybullet.JOINT_FIXED, [0.0, 0.0, 0.0], away.tolist(),
            [0.0, 0.0, 0.0], xyzw(turned), [0.0, 0.0, 0.0, 1.0], physicsClientId=world.client,
        )


def principal(mass: Mass, pieces: tuple[Piece, ...]) -> tuple[Array, Array]:
    """Return principal moments (3,) [kg m^2] and the frame (w, x, y, z) of their axes in the body's: those of its one piece,
    where they are that."""
    if len(pieces) == 1:
        axes = rotation.to_matrix(np.array(pieces[0].orientation))
        turned = axes.T @ mass.inertia @ axes
        moments = np.diag(turned).copy()
        if np.abs(turned - np.diag(moments)).max() <= 1e-12 * moments.max():
            return moments, np.array(pieces[0].orientation)
    return principal_axes(mass.inertia)


def _is_simple(body: Body) -> bool:
    """Return True if Bullet finds the stated inertia by itself; without multibody it cannot be given another."""
    if body.role is not Role.SIMULATED or body.mass is None or len(body.pieces) != 1:
        return False
    piece = body.pieces[0]
    if not isinstance(piece.shape, Sphere | Box) or any(piece.position) or piece.orientation != rotation.IDENTITY:
        return False
    expected = body.mass.mass * _inertia_per_mass(piece.shape)
    same = np.allclose(body.mass.inertia, expected, rtol=1e-9, atol=0.0)
    return same and not any(body.mass.centre)


@lru_cache(maxsize=256)
def _inertia_per_mass(shape: Sphere | Box) -> Array:
    """Return the inertia (3, 3) [m^2] of a solid of 1 kg; piles are made of many alike."""
    return solid((Piece(shape),), 1.0).inertia


def _body(body: Body, client: int, maximal: bool) -> Part:
    if body.role is Role.FIXED or body.mass is None:
        first, *more = (_still(body, pieces, client, maximal) for pieces in parted(body.pieces))
        return Part(first, -1, IDENTITY, np.zeros(3), also=tuple(more))
    moments, frame = principal(body.mass, body.pieces)
    centre = rotation.rotate(rotation.conjugate(frame), body.mass.centre)
    made = pybullet.createMultiBody(
        body.mass.mass, collision_shape(placed(body.pieces, frame, centre), client), basePosition=body.position,
        baseOrientation=xyzw(rotation.multiply(body.orientation, frame)), baseInertialFramePosition=centre.tolist(),
        useMaximalCoordinates=maximal, physicsClientId=client,
    )
    if not maximal:
        pybullet.changeDynamics(made, -1, localInertiaDiagonal=moments.tolist(), physicsClientId=client)
    pybullet.resetBaseVelocity(made, body.velocity, body.angular_velocity, physicsClientId=client)
    return Part(int(made), -1, frame, np.array(body.mass.centre))


def _still(body: Body, pieces: tuple[Piece, ...], client: int, maximal: bool) -> int:
    """Return a multibody that never moves, of some of a fixed body's pieces."""
    return int(pybullet.createMultiBody(
        0.0, collision_shape(placed(pieces, IDENTITY, np.zeros(3)), client), basePosition=body.position,
        baseOrientation=xyzw(body.orientation), useMaximalCoordinates=maximal, physicsClientId=client,
    ))


@dataclass(eq=False)
class _Chain:
    """The columns of createMultiBody for one avatar and the parts of its links; joint -> moments and joint -> limits, to be set
    afterwards; limits of ball joints. `hulls`: boxes as hulls; `apart`: several pieces as links."""

    hulls: bool
    apart: bool
    columns: dict[str, list[Any]] = field(default_factory=dict)
    moments: dict[int, list[float]] = field(default_factory=dict)
    stops: dict[int, tuple[float, float]] = field(default_factory=dict)
    shapes: list[list[Placed]] = field(default_factory=list)
    ball_limits: dict[int, SwingTwist] = field(default_factory=dict)

    def made(self, base: dict[str, object], shape: list[Placed], client: int) -> int:
        """Make the multibody with a base of `shape`, from a file where ball joints have limits, else by calls; return its id."""
        if self.ball_limits:
            return urdf.load(base, shape, self.columns, self.shapes, self.ball_limits, client)
        return int(pybullet.createMultiBody(
            **base, baseCollisionShapeIndex=collision_shape(shape, client), **self.columns,
            linkCollisionShapeIndices=[collision_shape(parts, client) for parts in self.shapes],
            flags=pybullet.URDF_USE_SELF_COLLISION, physicsClientId=client,
        ))

    def add(self, parent: int, place: Array, turn: Array, kind: int, axis: Vector | list[float], mass: float,
            moments: list[float], shape: list[Placed], centre: Array | None = None) -> int:
        """Append one Bullet link below link `parent` (-1: base); return its index."""
        row: dict[str, object] = {
            "linkMasses": mass, "linkVisualShapeIndices": -1, "linkPositions": place.tolist(),
            "linkOrientations": xyzw(turn), "linkParentIndices": parent + 1,
            "linkInertialFramePositions": [0.0] * 3 if centre is None else centre.tolist(),
            "linkInertialFrameOrientations": [0.0, 0.0, 0.0, 1.0], "linkJointTypes": kind, "linkJointAxis": list(axis),
        }
        for name, value in row.items():
            self.columns.setdefault(name, []).append(value)
        index = len(self.shapes)
        self.shapes.append(shape)
        if mass > 0.0:
            self.moments[index] = moments
        return index

    def shape(self, link: Link, frame: Array, centre: Array) -> list[Placed]:
        """Return the parts of a link itself: none if its pieces are links."""
        return placed(() if self._splits(link) else link.pieces, frame, centre, self.hulls)

    def pieces(self, link: Link, index: int, frame: Array) -> tuple[int, ...]:
        """Append the links that carry the pieces of link `index`, unless it does itself; return those links.

        A compound meets nothing before boxes around its parts overlap. A piece on a link of its own, which is fixed to its link
        and weighs nothing, is met before it overlaps, as a link of one piece is.
        """
        if not self._splits(link):
            return (index,)
        back, made = rotation.conjugate(frame), list[int]()
        for piece in link.pieces:
            place, turn = rotation.rotate(back, piece.position), rotation.multiply(back, piece.orientation)
            shape = placed((Piece(piece.shape),), IDENTITY, np.zeros(3), self.hulls)
            made.append(self.add(index, place, turn, pybullet.JOINT_FIXED, [0.0, 0.0, 1.0], 0.0, [], shape))
        return tuple(made)

    def _splits(self, link: Link) -> bool:
        return self.apart and len(link.pieces) > 1


def _avatar(world: World, scene: Scene, avatar: Avatar, first: int, limits: bool, ball_limits: bool, chain: _Chain) -> None:
    client = world.client
    parts: dict[str, tuple[int, Array, Array, tuple[int, ...]]] = {}
    hinges: dict[int, list[int]] = {}
    balls: list[tuple[int, int]] = []
    root = avatar.links[0]
    free = isinstance(root.joint, Free)
    for k in _depth_first(avatar):
        link = avatar.links[k]
        moments, frame = principal(link.mass, link.pieces)
        if k == 0 and free:
            parts[link.name] = (-1, frame, np.array(link.mass.centre), chain.pieces(link, -1, frame))
            continue
        turn, left = np.asarray(link.orientation), rotation.conjugate(frame)
        ball = link.joint.limits if ball_limits and isinstance(link.joint, Ball) else None
        if ball is not None:
            turn, (moments, frame) = urdf.zero(ball), urdf.along_limb(ball, moments, frame)
            left = rotation.multiply(rotation.conjugate(rotation.multiply(turn, frame)), link.orientation)
        above, above_frame = (-1, IDENTITY) if link.parent is None else parts[link.parent][:2]
        back = rotation.conjugate(above_frame)
        index, hinges[k] = _joint(chain, link, above, rotation.rotate(back, link.anchor),
                                  rotation.multiply(back, turn), frame, moments.tolist(), limits)
        if ball is not None:
            chain.ball_limits[index] = ball
        parts[link.name] = (index, frame, np.array(link.mass.centre), chain.pieces(link, index, frame))
        if isinstance(link.joint, Ball):
            balls.append((index, first + k))
            world.lefts[first + k] = left
    start, base, shape = scene.first_sample, dict[str, object](), list[Placed]()
    if free:
        moments, frame = principal(root.mass, root.pieces)
        centre = rotation.rotate(rotation.conjugate(frame), root.mass.centre)
        shape = chain.shape(root, frame, centre)
        base = {
            "baseMass": root.mass.mass,
            "basePosition": start.positions[first].tolist(),
            "baseOrientation": xyzw(rotation.multiply(rotation.normalised(start.rotations[first]), frame)),
            "baseInertialFramePosition": centre.tolist(),
        }
    made = chain.made(base, shape, client)
    if free:
        pybullet.changeDynamics(made, -1, localInertiaDiagonal=moments_of(root), physicsClientId=client)
        world.roots.append((len(world.parts), first))
    for index, principal_moments in chain.moments.items():
        pybullet.changeDynamics(made, index, localInertiaDiagonal=principal_moments, physicsClientId=client)
    for index, (lower, upper) in chain.stops.items():
        pybullet.changeDynamics(made, index, jointLowerLimit=lower, jointUpperLimit=upper, physicsClientId=client)
    world.hinges += [(made, index) for k in sorted(hinges) for index in hinges[k]]
    world.balls += [(made, index, k) for index, k in sorted(balls, key=lambda ball: ball[1])]
    world.parts += [Part(made, *parts[link.name]) for link in avatar.links]


def _depth_first(avatar: Avatar) -> list[int]:
    """Return places of the links, each branch to its end before the next: the order in which Bullet numbers links
    itself."""
    below: dict[str | None, list[int]] = {}
    for k, link in enumerate(avatar.links):
        below.setdefault(link.parent, []).append(k)
    order, waiting = [], [0]
    while waiting:
        k = waiting.pop()
        order.append(k)
        waiting += reversed(below.get(avatar.links[k].name, []))
    return order


def moments_of(link: Link) -> list[float]:
    """Return principal moments of a link, as a list."""
    moments: list[float] = principal(link.mass, link.pieces)[0].tolist()
    return moments


def _joint(chain: _Chain, link: Link, above: int, place: Array, turn: Array, frame: Array, moments: list[float],
           limits: bool) -> tuple[int, list[int]]:
    """Append a link with its joint, and stand-ins before it where several hinges share a centre: its index,
    its hinges."""
    back = rotation.conjugate(frame)
    centre = rotation.rotate(back, link.mass.centre)
    shape = chain.shape(link, frame, centre)
    kind = pybullet.JOINT_SPHERICAL if isinstance(link.joint, Ball) else pybullet.JOINT_FIXED
    if not isinstance(link.joint, Hinges | Slide):
        assert isinstance(link.joint, Ball | Rigid)
        turned = rotation.multiply(turn, frame)
        return chain.add(above, place, turned, kind, [0.0, 0.0, 1.0], link.mass.mass, moments, shape, centre), []
    hinges: list[int] = []
    *before, last = axes_of(link.joint)
    for hinge in before:
        small = [BETWEEN_HINGES * float(np.mean(moments))] * 3
        above = chain.add(above, place, turn, pybullet.JOINT_REVOLUTE, hinge.axis, BETWEEN_HINGES * link.mass.mass, small, [])
        hinges.append(above)
        place, turn = np.zeros(3), IDENTITY
    axis = rotation.rotate(back, last.axis).tolist()
    turned = rotation.multiply(turn, frame)
    moves = pybullet.JOINT_PRISMATIC if isinstance(link.joint, Slide) else pybullet.JOINT_REVOLUTE
    index = chain.add(above, place, turned, moves, axis, link.mass.mass, moments, shape, centre)
    hinges.append(index)
    most = LONGEST_SLIDE if isinstance(link.joint, Slide) else MANY_TURNS
    for joint, hinge in zip(hinges, axes_of(link.joint), strict=True):
        if limits and not (hinge.lower <= -most and hinge.upper >= most):
            chain.stops[joint] = (hinge.lower, hinge.upper)
    return index, hinges


def _filter(world: World, scene: Scene) -> None:
    """Filter to exactly the scene's pairs: Bullet tests all that are not switched off here."""
    still = np.array([role is Role.FIXED for role in scene.roles])
    n = len(scene.names)

    def say(pairs: Iterable[tuple[tuple[int, int], tuple[int, int]]], meet: bool) -> None:
        for (one, link), (two, other) in pairs:
            pybullet.setCollisionFilterPair(one, two, link, other, int(meet), physicsClientId=world.client)

    for a, one in enumerate(world.parts):
        say(combinations(one.carriers, 2), False)
        for b in range(a + 1, n):
            if still[a] and still[b]:
                continue
            two = world.parts[b]
            if one.body == two.body or not scene.contact_filter[a, b]:
                say(product(one.carriers, two.carriers), bool(scene.contact_filter[a, b]))
