"""Values for the doors of `avatarsim`: valid ones of every kind, and anything else that Python can make."""

import datetime
import decimal
import fractions
from collections.abc import Callable

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import TABLE_1, Body, ContactLaw, Mass, PairTable, fixed, simulated, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint, ReachCone, Rigid, SwingTwist
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, rest

Any = SearchStrategy[object]

EXTREMES = (
    0, -0.0, 1, -1, True, False, 5e-324, 1e-320, 1e-12, 1e-6, 1e6, 1e7, 1e9, 1e154, 1e300, 1.7e308, float("inf"), -float("inf"),
    float("nan"), 10**20, 10**400, -(10**400), 2**31, 2**63, np.float32(1.5), np.int8(3), np.float64("nan"), np.bool_(True),
)
"""Numbers at the ends of their ranges, and things that are nearly numbers."""

numbers: Any = st.one_of(st.sampled_from(EXTREMES), st.floats(-10.0, 10.0), st.floats(), st.integers())
"""Any number."""

some_numbers: Any = st.lists(numbers, min_size=3, max_size=4).map(tuple)
"""Vectors and quaternions of any numbers."""


class Strange:
    """An object that answers with nonsense when it is looked at."""

    def __len__(self) -> int:
        return 3

    def __getitem__(self, key: object) -> object:
        return self

    def __float__(self) -> float:
        raise ZeroDivisionError("no number")

    def __eq__(self, other: object) -> bool:
        raise RuntimeError("not to be compared")

    __hash__ = None  # type: ignore[assignment]


def arrays() -> Any:
    """numpy arrays of every kind and of odd shapes."""
    kinds = st.sampled_from(("f8", "f4", "i8", "?", "c16", "U3", "S3", "O", "M8[s]", "f2"))
    shapes = st.sampled_from(((), (0,), (1,), (3,), (4,), (2, 3), (3, 3), (4, 3), (8, 3), (0, 3), (3, 0), (1, 1, 3), (2, 4)))
    plain = st.builds(lambda kind, shape: np.zeros(shape, dtype=kind), kinds, shapes)
    random = st.builds(lambda seed, shape: np.random.default_rng(seed).normal(size=shape), st.integers(0, 99), shapes)
    holes = st.builds(lambda shape, bad: np.full(shape, bad), shapes, st.sampled_from((np.nan, np.inf, 1e308, -1e308)))
    masked = st.builds(lambda shape: np.ma.masked_array(np.ones(shape), mask=True), shapes)
    odd = st.builds(lambda seed: np.asfortranarray(np.random.default_rng(seed).normal(size=(6, 6)))[::2, ::-2], st.integers(0, 9))
    return st.one_of(plain, random, holes, masked, odd)


singles: Any = st.one_of(
    st.none(), numbers, st.text(max_size=8), st.binary(max_size=8), st.complex_numbers(), arrays(),
    st.sampled_from((object(), int, print, ..., NotImplemented, range(3), Strange(), decimal.Decimal("1.5"),
                     fractions.Fraction(1, 3), datetime.date(2020, 1, 1), decimal.Decimal("NaN"), "\ud800", "a" * 5000, "nan",
                     b"\xff", Exception("x"))),
    st.builds(lambda: iter([1.0, 2.0, 3.0])),
    st.sampled_from((Sphere(0.1), Piece(Sphere(0.1)), Free(), Rigid(), Hinge((1.0, 0.0, 0.0), -1.0, 1.0), Mass(1.0),
                     ContactLaw(0.5, 0.5), TABLE_1, Sphere, Box, fixed("f", (Piece(Sphere(0.1)),), "wood"), rest(()))),
)
"""Anything that has no parts."""

anything: Any = st.recursive(
    singles, lambda inner: st.one_of(
        st.lists(inner, max_size=5), st.lists(inner, max_size=4).map(tuple),
        st.dictionaries(st.text(max_size=3), inner, max_size=3), some_numbers, st.sets(st.integers(), max_size=3),
    ), max_leaves=6,
)
"""Anything at all."""

lengths = st.floats(0.02, 0.5)
rates = st.one_of(
    st.none(), st.floats(0.1, 20.0), st.lists(st.floats(0.1, 20.0), min_size=3, max_size=3),
    st.fixed_dictionaries({"trunk": st.tuples(*[st.floats(0.1, 5.0)] * 2), "left": st.none(), "right": st.just(2.0)}),
)
vectors = st.tuples(*[st.floats(-3.0, 3.0)] * 3)
names = st.one_of(st.sampled_from(("a", "b", "hand", "x" * 200, "Ä/ö", "a b", "\n", "..")), st.text(min_size=1, max_size=6))
seeds = st.integers(0, 999)


def units(size: int) -> SearchStrategy[tuple[float, ...]]:
    """Return vectors of length 1."""

    def made(seed: int) -> tuple[float, ...]:
        drawn = np.random.default_rng(seed).normal(size=size)
        return tuple(float(value) for value in drawn / np.linalg.norm(drawn))

    return st.one_of(st.just((1.0,) + (0.0,) * (size - 1)), seeds.map(made))


quaternions, directions = units(4), units(3)
points = st.builds(lambda seed, count: 0.2 * np.random.default_rng(seed).normal(size=(count, 3)), seeds, st.integers(4, 30))
shapes: SearchStrategy[Shape] = st.one_of(
    st.builds(Sphere, lengths), st.builds(Capsule, lengths, lengths), st.builds(Box, st.tuples(lengths, lengths, lengths)),
    st.builds(Ellipsoid, st.tuples(lengths, lengths, lengths)), st.builds(ConvexHull, points),
    st.builds(lambda radii: ellipsoid_hull(radii, 20), st.tuples(lengths, lengths, lengths)),
)
pieces = st.builds(Piece, shapes, st.tuples(*[st.floats(-0.3, 0.3)] * 3), quaternions)
piece_tuples = st.lists(pieces, min_size=1, max_size=2).map(tuple)
masses = st.builds(solid, piece_tuples, st.floats(0.1, 20.0))
materials = st.sampled_from(("wood", "human", "metal"))
contacts = st.builds(ContactLaw, st.floats(0.0, 1.0), st.floats(0.0, 2.0))
hinges = st.builds(lambda axis, a, b: Hinge(axis, min(a, b), max(a, b)), directions, st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
swings = st.builds(SwingTwist, directions, directions, st.floats(0.1, 2.0), st.tuples(st.floats(-2.0, 0.0), st.floats(0.0, 2.0)))


def ring(count: int, wide: float) -> np.ndarray:
    """Return corners of a reach cone about z."""
    turn = 2.0 * np.pi * np.arange(count) / count
    return np.stack([np.sin(wide) * np.cos(turn), np.sin(wide) * np.sin(turn), np.full(count, np.cos(wide))], axis=-1)


cones = st.builds(lambda count, wide: ReachCone(ring(count, wide), (0.0, 0.0, 1.0)), st.integers(3, 8), st.floats(0.1, 1.4))
joints: SearchStrategy[Joint] = st.one_of(
    st.just(Rigid()), st.lists(hinges, min_size=1, max_size=3).map(tuple).map(Hinges), st.builds(Ball, st.none() | swings),
    st.builds(lambda cone: Ball(None, cone), cones),
)
roots: SearchStrategy[Joint] = st.one_of(st.just(Free()), joints)


def chain(joints_below: list[Joint], shapes_of: list[tuple[Piece, ...]], root: Joint) -> Avatar:
    """Return an avatar of one limb: links half a metre apart."""
    links = [Link("0", None, root, shapes_of[0], solid(shapes_of[0], 1.0))]
    for k, (joint, own) in enumerate(zip(joints_below, shapes_of[1:], strict=False), start=1):
        links.append(Link(f"{k}", f"{k - 1}", joint, own, solid(own, 1.0), anchor=(0.0, 0.0, 0.5)))
    return Avatar("avatar", tuple(links), (links[-1].name,))


avatars = st.one_of(
    st.builds(lambda own, kg: rigid_avatar("palm", own, solid(own, kg)), piece_tuples, st.floats(0.1, 5.0)),
    st.builds(chain, st.lists(joints, max_size=3), st.lists(piece_tuples, min_size=4, max_size=4), roots),
)


def body(kind: int, name: str, own: tuple[Piece, ...], material: str, place: tuple[float, float, float], kg: float,
         velocity: tuple[float, float, float]) -> Body:
    """Return a fixed or a simulated body."""
    return fixed(name, own, material, place) if kind else simulated(name, own, material, solid(own, kg), place, velocity=velocity)


bodies = st.builds(body, st.integers(0, 1), names.filter(lambda text: bool(text.strip())), piece_tuples, materials, vectors,
                   st.floats(0.1, 20.0), vectors)


def sample(of: tuple[Avatar, ...], seed: int, reach: float) -> TrackerSample:
    """Return any posture of avatars."""
    drawn, links = np.random.default_rng(seed), sum(len(avatar.links) for avatar in of)
    turns = drawn.normal(size=(links, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    angles = drawn.uniform(-3.0, 3.0, sum(avatar.hinge_count for avatar in of))
    return TrackerSample(0.0, drawn.uniform(-reach, reach, (links, 3)), turns, angles)


samples = st.builds(sample, avatars.map(lambda avatar: (avatar,)), seeds, st.floats(0.0, 10.0))
tables = st.builds(PairTable, st.dictionaries(st.tuples(st.just("wood"), materials), contacts, min_size=1))

Asked = tuple[Callable[..., object], dict[str, object]]
"""A constructor, or a function, and its arguments."""


def asked(make: Callable[..., object], **parts: SearchStrategy[object]) -> SearchStrategy[Asked]:
    """Return a constructor and its arguments: valid ones, of which some were replaced by any number or by anything."""
    valid = st.fixed_dictionaries(parts)
    replaced = st.dictionaries(st.sampled_from(sorted(parts)), st.one_of(anything, numbers, some_numbers), max_size=2)
    return st.tuples(st.just(make), st.builds(lambda a, b: {**a, **b}, valid, replaced))
