"""A tree of MuJoCo bodies as links: frames in the joints' centres, hinges about one centre together, angles from the reference.

MuJoCo turns a body about its joints one after the other, each about its own centre in the body (mj_kinematics); a link has one
centre. So joints of one body whose centres differ become links of their own, without pieces, one below the other.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.compiled import Compiled, JointKind
from avatarsim.assets.models.coordinates import Coordinates, Slot
from avatarsim.assets.models.joint_couplings import Line, curved, lines, narrowed
from avatarsim.assets.models.masses import Masses
from avatarsim.assets.models.pieces_of_geoms import Geoms, quaternion_of, vector_of
from avatarsim.errors import InvalidFile, InvalidInput, UnknownName
from avatarsim.scene.avatar import Link
from avatarsim.scene.body import Mass
from avatarsim.scene.joint import (
    LONGEST_SLIDE,
    MANY_TURNS,
    WIDEST_SWING,
    Ball,
    Coupling,
    Free,
    Hinge,
    Hinges,
    Joint,
    Rigid,
    Slide,
    SwingTwist,
    axes_of,
)
from avatarsim.scene.shape import Piece
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

TOGETHER = 1e-12
"""[m] Centres of joints nearer than this are one: a file writes both with the same digits."""

UNTURNED = np.array(rotation.IDENTITY)
"""The identity rotation."""

MOST_HINGES = 3
"""Most hinges of one link."""

CENTRED = (JointKind.HINGE, JointKind.BALL)
"""Kinds of joints that have a centre; a slide's position in the file means nothing."""

ROOTS = ("file", "free", "fixed")
"""Motion of an avatar's root: as the file states, free, or fixed."""


@dataclass(frozen=True)
class JointOptions:
    """Options of joints: names to `fix` at their reference, or "all" for those that an avatar cannot have; how the
    `root` moves."""

    fix: tuple[str, ...] | str = ()
    root: str = "file"

    def __post_init__(self) -> None:
        if self.root not in ROOTS:
            raise UnknownName("root", str(self.root), ROOTS)
        names = isinstance(self.fix, tuple) and all(isinstance(name, str) for name in self.fix)
        if not names and self.fix != "all":
            raise InvalidInput("fix", self.fix, 'a tuple of names of joints, or "all"')


@dataclass(frozen=True, eq=False)
class Tree:
    """Bodies below one body of the world, or several, `bodies` from the root on, parents first, and the joints that move them.

    `joints` [body] are the numbers of its joints that move, in the order in which they act; `fixed` those of the tree that are
    fixed at their reference; `lines` how joints follow others, `limits` of hinges and slides [rad, m]. `is_free` is True if the
    root moves freely, `weld` [body] is the first of the bodies that it is rigid with (0: the world)."""

    model: Compiled
    bodies: tuple[int, ...]
    joints: dict[int, tuple[int, ...]]
    fixed: tuple[int, ...]
    lines: dict[int, Line]
    limits: dict[int, tuple[float, float]]
    is_free: bool
    weld: dict[int, int]
    notes: tuple[str, ...]

    @property
    def root(self) -> int:
        """The tree's first body."""
        return self.bodies[0]


def trees(model: Compiled) -> list[tuple[int, ...]]:
    """Return the bodies below each body of the world, parents first."""
    top = np.arange(len(model.body_name))
    for body in range(1, len(top)):
        parent = int(model.body_parentid[body])
        top[body] = body if parent == 0 else top[parent]
    return [tuple(int(k) for k in np.flatnonzero(top == root)) for root in np.unique(top[1:])]


def joint_name(model: Compiled, joint: int) -> str:
    """Return the name of a joint in errors, sentences and coordinates."""
    body = int(model.jnt_bodyid[joint])
    return model.jnt_name[joint] or f"joint {joint} of {model.body_name[body] or f'body {body}'}"


def tree_of(model: Compiled, bodies: tuple[int, ...], wanted: JointOptions, file: str) -> Tree:
    """Return the tree with fixed joints, or raise InvalidFile with the joints that an avatar cannot have, and advice."""
    own = [int(j) for j in np.flatnonzero(np.isin(model.jnt_bodyid, bodies))]
    names = {joint_name(model, j): j for j in own}
    notes: list[str] = []
    for name in wanted.fix if isinstance(wanted.fix, tuple) else ():
        if name not in names:
            raise UnknownName(f"joint to fix of {file}", name, names)
    asked = set(names.values()) if wanted.fix == "all" else {names[name] for name in wanted.fix}
    bent = curved(model, own)
    if refused := {j: powers for j, powers in bent.items() if j not in asked}:
        listed = ", ".join(f"{joint_name(model, j)} ({powers})" for j, powers in refused.items())
        valid = 'straight lines, c2 = c3 = c4 = 0; fix=(name, ...) or fix="all" holds these joints at their reference'
        raise InvalidFile(f"polynomials of coupled joints of {file}", listed, valid)
    fixed = asked & set(bent) if wanted.fix == "all" else asked
    free = [j for j in own if model.jnt_type[j] == JointKind.FREE]
    if wanted.root == "fixed":
        fixed |= set(free)
    if fixed:
        notes.append(f"fixed at the reference: {_list(model, sorted(fixed))}")
    tops = [b for b in bodies if model.body_parentid[b] == 0]
    if len(tops) > 1 and (wanted.root == "free" or set(free) - fixed):
        valid = 'a file whose trees are fixed to the world where several are one avatar; root="fixed" holds their free joints'
        raise InvalidFile(f"trees of the avatar in {file}", "free", valid)
    is_free = (wanted.root == "free" or bool(free)) and not fixed & set(free)
    joints = {b: tuple(j for j in own if model.jnt_bodyid[j] == b and j not in fixed) for b in bodies}
    weld: dict[int, int] = {0: 0}
    for b in bodies:
        moves = joints[b] or (is_free and b == bodies[0])
        weld[b] = b if moves else weld[int(model.body_parentid[b])]
    found = lines(model, own, sorted(fixed), file)
    limits = narrowed(found, {j: _limits(model, j) for j in own if j not in fixed}, {j: joint_name(model, j) for j in own}, file)
    if found:
        notes.append(f"coupled joints follow others: {_list(model, sorted(found))}")
    return Tree(model, bodies, joints, tuple(sorted(fixed)), found, limits, is_free, weld, tuple(notes))


def _list(model: Compiled, joints: Sequence[int]) -> str:
    return ", ".join(joint_name(model, j) for j in joints)


def _groups(model: Compiled, tree: Tree, body: int) -> list[tuple[int, ...]]:
    """Return a body's joints in the groups that one link can have: free, ball, slide, or up to three hinges about a centre."""
    groups: list[tuple[int, ...]] = []
    for j in tree.joints[body]:
        last = groups[-1] if groups else ()
        hinges = model.jnt_type[j] == JointKind.HINGE and last and model.jnt_type[last[0]] == JointKind.HINGE
        if hinges and len(last) < MOST_HINGES and np.abs(model.jnt_pos[j] - model.jnt_pos[last[0]]).max() <= TOGETHER:
            groups[-1] = (*last, j)
        else:
            groups.append((j,))
    return groups


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Links of a tree, coordinates of its joints, couplings of their angles, and offsets of frames.
    These are the positions (3,) [m], in a body's frame, of the frame of the link that carries it."""

    links: tuple[Link, ...]
    coordinates: Coordinates
    couplings: tuple[Coupling, ...]
    centres: dict[int, Array]


def skeleton_of(
    tree: Tree, names: dict[int, str], geoms: Geoms, masses: Masses, material: Callable[[int], str]
) -> Skeleton:
    """Return the links of a tree, of the `material` of a body; body b is carried by the link of its name.
    Raises InvalidFile for an unsupported shape."""
    links: list[Link] = []
    moved: dict[int, int] = {}
    offsets: dict[int, Array] = {0: np.zeros(3)}
    first_hinge: dict[int, int] = {}
    hinges = 0
    if sum(tree.model.body_parentid[b] == 0 for b in tree.bodies) > 1:
        # one link for the world, to which all of the trees are jointed
        links.append(Link(names[0], None, Rigid(), (), masses.nothing(), material(0)))
    for body in tree.bodies:
        for place in _places(tree, body, names, offsets, geoms, masses):
            parent = None if not links else place.parent
            anchor, turn = vector_of(place.anchor), quaternion_of(place.turn)
            links.append(Link(place.name, parent, place.joint, place.pieces, place.mass, material(body), anchor, turn))
            for j in place.joints:
                moved[j] = len(links) - 1
                if axes_of(place.joint):
                    first_hinge[j] = hinges
                    hinges += 1
    slots = tuple(_slots(tree, moved, first_hinge))
    couplings = tuple(
        Coupling(first_hinge[j], first_hinge[line.leader], line.ratio, line.offset)
        for j, line in sorted(tree.lines.items()) if line.leader >= 0
    )
    coordinates = Coordinates(slots, len(links), hinges)
    return Skeleton(tuple(links), coordinates, couplings, offsets)


@dataclass(frozen=True, eq=False)
class _Place:
    """One future link: its parent, its joint's centre and rest orientation in the parent's frame, and the pieces it carries."""

    name: str
    parent: str
    joint: Joint
    joints: tuple[int, ...]
    anchor: Array
    turn: Array
    pieces: tuple[Piece, ...]
    mass: Mass


def _places(
    tree: Tree, body: int, names: dict[int, str], offsets: dict[int, Array], geoms: Geoms, masses: Masses
) -> Iterator[_Place]:
    """Return the links of one body, the last of which carries it. `offsets` are from bodies to the frames of their links."""
    model = tree.model
    above = int(model.body_parentid[body])
    origin, turn = model.body_pos[body] - offsets[above], model.body_quat[body]
    groups: list[tuple[int, ...]] = _groups(model, tree, body)
    parent, before = names[above], np.zeros(3)
    if body == tree.root and tree.is_free and not (groups and model.jnt_type[groups[0][0]] == JointKind.FREE):
        # the file's root does not move, or turns about joints of its own
        groups = [(), *groups]
    for k, group in enumerate(groups or [()]):
        is_last = k >= len(groups) - 1
        centre = model.jnt_pos[group[0]] if group and model.jnt_type[group[0]] in CENTRED else np.zeros(3)
        joint = _joint(tree, body, group, turn if k == 0 else UNTURNED)
        name = names[body] if is_last else f"{names[body]} before {joint_name(model, groups[k + 1][0])}"
        anchor = origin + rotation.rotate(turn, centre) if k == 0 else centre - before
        pieces = tuple(p for g in geoms.of(body) for p in geoms.pieces(g, -centre, UNTURNED)) if is_last else ()
        mass = masses.of((body,), {body: (-centre, UNTURNED)}, pieces) if is_last else masses.nothing()
        yield _Place(name, parent, joint, group, anchor, turn if k == 0 else UNTURNED, pieces, mass)
        parent, before = name, centre
    offsets[body] = before


def _joint(tree: Tree, body: int, group: tuple[int, ...], turn: Array) -> Joint:
    """Return the joint for a group of MuJoCo's joints, of a link that is turned by `turn` in its parent at rest."""
    model = tree.model
    if not group:
        return Free() if body == tree.root and tree.is_free else Rigid()
    kind = model.jnt_type[group[0]]
    if kind == JointKind.FREE:
        return Free()
    if kind == JointKind.BALL:
        return _ball(model, body, group[0], turn)
    if kind == JointKind.SLIDE:
        return Slide(vector_of(model.jnt_axis[group[0]]), *tree.limits[group[0]])
    return Hinges(tuple(Hinge(vector_of(model.jnt_axis[j]), *tree.limits[j]) for j in group))


def _limits(model: Compiled, j: int) -> tuple[float, float]:
    """Return the limits of a hinge [rad] or a slide [m] from the reference, the widest if it has none."""
    farthest = LONGEST_SLIDE if model.jnt_type[j] == JointKind.SLIDE else MANY_TURNS
    if not model.jnt_limited[j]:
        return -farthest, farthest
    low, high = np.clip(model.jnt_range[j] - model.qpos0[model.jnt_qposadr[j]], -farthest, farthest)
    return float(low), float(high)


def _ball(model: Compiled, body: int, j: int, turn: Array) -> Ball:
    """Return a ball for a MuJoCo joint, which limits the angle of the whole turn.
    The half turn that swing s and twist t about one axis make together has the cosine cos(s/2) cos(t/2), so equal limits of both
    that make it at their corner lie within; the axis is that from the joint to the centre of mass."""
    whole = float(model.jnt_range[j, 1])
    if not model.jnt_limited[j] or whole >= np.pi:
        return Ball()
    # cos^2 of half an angle: 2 cos^2(x / 2) = 1 + cos x
    cosine = 2.0 * np.cos(0.5 * whole) - 1.0
    each = min(float(np.arctan2(np.sqrt(max(0.0, 1.0 - cosine * cosine)), cosine)), WIDEST_SWING)
    limb = model.body_ipos[body] - model.jnt_pos[j]
    if not np.linalg.norm(limb) > TOGETHER:
        limb = np.array([0.0, 0.0, 1.0])
    axis = vector_of(limb)
    centre = vector_of(rotation.rotate(turn, limb))
    return Ball(SwingTwist(axis, centre, each, (-each, each)))


def _slots(tree: Tree, moved: dict[int, int], first_hinge: dict[int, int]) -> Iterator[Slot]:
    """Yield the coordinates in the file's order; fixed joints keep their columns."""
    model = tree.model
    own = [int(j) for j in np.flatnonzero(np.isin(model.jnt_bodyid, tree.bodies))]
    if tree.is_free and not any(model.jnt_type[j] == JointKind.FREE for j in own):
        yield Slot("root", "free", 0)
    for j in own:
        name, kind, address = joint_name(model, j), JointKind(int(model.jnt_type[j])), int(model.jnt_qposadr[j])
        if j in tree.fixed:
            width = {JointKind.FREE: 7, JointKind.BALL: 4}.get(kind, 1)
            for k in range(width):
                yield Slot(name if width == 1 else f"{name} {k}", "fixed", -1, rest=float(model.qpos0[address + k]))
        elif j in first_hinge:
            yield Slot(
                name, kind.name.lower(), moved[j], first_hinge[j], float(model.qpos0[address]), float(model.jnt_velocity[j])
            )
        else:
            yield Slot(name, kind.name.lower(), moved[j])

