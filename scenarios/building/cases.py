"""Bodies, materials and turns that scenes are laid out with."""

from collections.abc import Iterable, Mapping
from itertools import combinations_with_replacement
from math import hypot

from avatarsim.scene.avatar import Avatar, rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, Mass, PairTable, fixed, simulated, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.shape import Box, Piece, Shape
from avatarsim.spatial import rotation

Solid = Shape | Piece | tuple[Piece, ...]

LAID = 2e-8
"""Gap [m] at which a body is laid on another at the start: free of overlap beyond the judge's rounding, below every bound."""

NOWHERE = (0.0, 0.0, 0.0)
"""The origin, and also no gravity and no velocity."""


def pieces_of(shape: Solid) -> tuple[Piece, ...]:
    """Return a shape, a piece or a tuple of pieces as a tuple of pieces."""
    return shape if isinstance(shape, tuple) else (shape if isinstance(shape, Piece) else Piece(shape),)


def fixture(name: str, shape: Solid, material: str, position: Vector = NOWHERE, turn: Quaternion = rotation.IDENTITY) -> Body:
    """Return a fixed body."""
    return fixed(name, pieces_of(shape), material, position, turn)


def slab(width: float, depth: float, material: str = "floor", name: str = "floor", x: float = 0.0, z: float = 0.0) -> Body:
    """Return a fixed floor 0.2 m thick, `width` along x about `x` and `depth` along y [m], its upper face at `z` [m]."""
    return fixture(name, Box((width, depth, 0.2)), material, (x, 0.0, z - 0.1))


def loose(
    name: str, shape: Solid, material: str, mass: float | Mass, position: Vector = NOWHERE,
    turn: Quaternion = rotation.IDENTITY, velocity: Vector = NOWHERE, spin: Vector = NOWHERE,
) -> Body:
    """Return a simulated body with its first velocity [m/s] and spin [rad/s]; a `mass` [kg] is spread over its pieces."""
    pieces = pieces_of(shape)
    spread = mass if isinstance(mass, Mass) else solid(pieces, mass)
    return simulated(name, pieces, material, spread, position, turn, velocity, spin)


def driven(name: str, shape: Solid, mass: float, material: str = "human") -> Avatar:
    """Return a rigid hand of `mass` [kg]."""
    pieces = pieces_of(shape)
    return rigid_avatar(name, pieces, solid(pieces, mass), material)


def pair_table(names: Iterable[str], stated: Mapping[tuple[str, str], ContactLaw]) -> PairTable:
    """Return coefficients of made-up materials: the pairs `stated`, and neither bounce nor friction for pairs that never meet."""
    known, pairs = {frozenset(pair) for pair in stated}, combinations_with_replacement(sorted(names), 2)
    return PairTable({**{pair: ContactLaw(0.0, 0.0) for pair in pairs if frozenset(pair) not in known}, **stated})


def laws(stated: Mapping[tuple[str, str], tuple[float, float]], *others: str) -> PairTable:
    """Return the table of (restitution, friction) by pair of materials; `others` are materials without a law of their own."""
    names = {*others, *(name for pair in stated for name in pair)}
    return pair_table(names, {pair: ContactLaw(*law) for pair, law in stated.items()})


def one_law(restitution: float, friction: float, *pairs: tuple[str, str]) -> PairTable:
    """Return the table in which all `pairs` of materials have one law."""
    return laws(dict.fromkeys(pairs, (restitution, friction)))


def turned_by(axis: Vector, angle: float) -> Quaternion:
    """Return the turn by `angle` [rad] about `axis`, of any length."""
    length = hypot(*axis)
    unit = (axis[0] / length, axis[1] / length, axis[2] / length)
    w, x, y, z = rotation.from_axis_angle(unit, angle).tolist()
    return w, x, y, z
