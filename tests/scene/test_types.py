"""What is of another type than its place is for is refused at once, by a sentence that names the place."""

import math
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import InvalidInput, InvalidScene, InvalidShape
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import TABLE_1, Body, ContactLaw, Mass, PairTable, Role, fixed, simulated, solid
from avatarsim.scene.checks import FARTHEST, FASTEST, FASTEST_SPIN, Vector, finite_array, vector
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, SwingTwist
from avatarsim.scene.scene import HEAVIEST, Scene
from avatarsim.scene.shape import MOST_VERTICES, Box, ConvexHull, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, checked, rest

BALL = (Piece(Sphere(0.1)),)
MASS = solid(BALL, 1.0)
AXIS = (0.0, 0.0, 1.0)
FLOOR, HAND = fixed("floor", BALL, "wood"), rigid_avatar("hand", BALL, MASS)
MASKED = np.ma.masked_array([0.0, 0.0, 1.0], mask=[False, True, False])

WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "role": (lambda: Body("b", "fixed", BALL, "wood"), "role of body b is 'fixed'; valid: Role.FIXED or Role.SIMULATED"),
    "pieces as a list": (lambda: fixed("b", [Piece(Sphere(0.1))], "wood"), "pieces of body b is .*valid: a tuple"),
    "one piece": (lambda: fixed("b", Piece(Sphere(0.1)), "wood"), "pieces of body b is .*valid: a tuple"),
    "a shape for a piece": (lambda: fixed("b", (Sphere(0.1),), "wood"), r"pieces of body b, entry 0 is .*valid: a Piece\("),
    "a piece of nothing": (lambda: Piece(None), "shape of a piece is None; valid: a Sphere, Capsule"),
    "a piece of a piece": (lambda: Piece(Piece(Sphere(0.1))), "shape of a piece is Piece"),
    "a mass of a number": (lambda: simulated("b", BALL, "wood", 1.0), "mass of body b is 1.0; valid: a Mass"),
    "a material of a number": (lambda: fixed("b", BALL, 3), "name of the material of body b is 3"),
    "shapes of a solid": (lambda: solid((Sphere(0.1),), 1.0), "pieces of a solid, entry 0"),
    "corners of a hull": (lambda: ellipsoid_hull((1.0, 1.0, 1.0), "many"), "number of vertices .* 'many'"),
    "part of a corner": (lambda: ellipsoid_hull((1.0, 1.0, 1.0), 52.5), "number of vertices .* 52.5"),
    "a link's mass": (lambda: Link("l", None, Free(), BALL, 1.0), "mass of link l is 1.0; valid: a Mass"),
    "a link's pieces": (lambda: Link("l", None, Free(), Sphere(0.1), MASS), "pieces of link l is"),
    "a link's parent": (lambda: Link("l", 7, Free(), BALL, MASS), "parent of link l is 7"),
    "a link's material": (lambda: Link("l", None, Free(), BALL, MASS, None), "name of the material of link l is None"),
    "one link": (lambda: Avatar("a", Link("l", None, Free(), BALL, MASS)), "links of avatar a is .*valid: a tuple"),
    "chains": (lambda: replace(HAND, chains="hand"), "chains of avatar hand is 'hand'; valid: a tuple"),
    "ignore": (lambda: replace(HAND, ignore=("hand",)), "ignore of avatar hand, entry 0 is 'hand'; valid: a pair of names"),
    "sizes": (lambda: replace(HAND, size_range=1.0), "size_range of avatar hand is 1.0"),
    "sizes of no dimensions": (lambda: replace(HAND, size_range=np.array(1.0)), "size_range of avatar hand is "),
    "twist of no dimensions": (lambda: SwingTwist(AXIS, AXIS, 1.0, np.array(0.5)), r"twist limits \[rad\] is "),
    "pieces of no dimensions": (lambda: solid(np.array(1.0), 1.0), "pieces of a solid"),
    "sizes in words": (lambda: replace(HAND, size_range=("small", "large")), "size_range of avatar hand .* is 'small'"),
    "one hinge": (lambda: Hinges(Hinge(AXIS)), "hinges of a joint is Hinge.*valid: a tuple"),
    "an axis for a hinge": (lambda: Hinges((AXIS,)), "hinges of a joint, entry 0"),
    "limits of a ball": (lambda: Ball((0.0, 1.0)), "limits of a ball joint is"),
    "a cone of a ball": (lambda: Ball(None, AXIS), "cone of a ball joint is"),
    "a friction for a contact": (lambda: PairTable({("a", "b"): 0.5}), "contact of a and b is 0.5; valid: a ContactLaw"),
    "a name for a pair": (lambda: PairTable({"ab": ContactLaw(0.1, 0.1)}), "pairs of a PairTable, entry 0 is 'ab'"),
    "pairs as a list": (lambda: PairTable([("a", "b")]), "pairs of a PairTable is .*valid: a mapping"),
    "avatars for bodies": (lambda: Scene("s", (HAND,)), "bodies of scene s, entry 0 is .*valid: a Body"),
    "bodies for avatars": (lambda: Scene("s", (FLOOR,), (FLOOR,)), "avatars of scene s, entry 0 is .*valid: an Avatar"),
    "bodies as a list": (lambda: Scene("s", [FLOOR]), "bodies of scene s is .*valid: a tuple"),
    "a mapping for materials": (lambda: Scene("s", (FLOOR,), materials=dict(TABLE_1.pairs)), "materials of scene s is"),
    "exclude": (lambda: Scene("s", (FLOOR,), exclude=("floor",)), "exclude of scene s, entry 0 is 'floor'"),
    "narrow": (lambda: Scene("s", (FLOOR,), narrow="friction"), "narrow of scene s is 'friction'; valid: a tuple"),
    "require": (lambda: Scene("s", (FLOOR,), require=(1,)), "require of scene s, entry 0 is 1"),
    "a start": (lambda: Scene("s", (), (HAND,), start="here"), "tracker sample is 'here'; valid: a TrackerSample"),
    "a complex place": (lambda: fixed("b", BALL, "wood", (1j, 0.0, 0.0)), r"position of b \[m\] is .*real numbers"),
    "a masked place": (lambda: fixed("b", BALL, "wood", MASKED), r"position of b \[m\] is .*real numbers"),
    "a place in words": (lambda: fixed("b", BALL, "wood", ("1", "2", "3")), r"position of b \[m\] is .*real numbers"),
    "a place in letters": (lambda: fixed("b", BALL, "wood", "123"), r"position of b \[m\] is .*real numbers"),
    "truth for a place": (lambda: fixed("b", BALL, "wood", (True, False, True)), r"position of b \[m\] is .*real numbers"),
    "complex inertia": (lambda: Mass(1.0, inertia=np.eye(3) * (1.0 + 0.0j)), "inertia is .*real numbers"),
    "masked corners": (lambda: ConvexHull(np.ma.masked_array(np.eye(4, 3))), "hull vertices is .*real numbers"),
    "a complex axis": (lambda: SwingTwist((1j, 0.0, 0.0), AXIS, 1.0, (0.0, 1.0)), "swing axis is .*real numbers"),
}


@pytest.mark.parametrize("what", list(WRONG))
def test_another_type_is_refused_where_it_is_handed_in(what: str) -> None:
    make, said = WRONG[what]
    with pytest.raises(InvalidInput, match=said):
        make()


NO_NUMBERS = [np.array(["1", "2"]), np.array([1j, 0.0, 0.0]), MASKED, np.array([1, 2, "x"], dtype=object), b"abc", [None] * 3]
NUMBERS = [(1, 2, 3), np.array([1, 2, 3]), np.float32([1, 2, 3]), [np.int8(1), 2.0, np.float64(3)], range(1, 4)]


@pytest.mark.parametrize("value", NO_NUMBERS)
def test_arrays_hold_real_numbers(value: object) -> None:
    with pytest.raises(InvalidScene, match="v is .*; valid: real numbers of shape"):
        finite_array("v", value, (3,))


@pytest.mark.parametrize("value", NUMBERS)
def test_any_real_numbers_will_do(value: object) -> None:
    assert vector("v", value) == (1.0, 2.0, 3.0)


LIMITS = {"position": FARTHEST, "velocity": FASTEST, "angular_velocity": FASTEST_SPIN}


@pytest.mark.parametrize("field", list(LIMITS))
def test_places_and_velocities_have_a_largest_value_that_is_said(field: str) -> None:
    def body(x: float) -> Body:
        return Body("shot", Role.SIMULATED, BALL, "wood", mass=MASS, **{field: (0.0, 0.0, x)})

    most = LIMITS[field]
    assert getattr(body(-most), field) == (0.0, 0.0, -most)
    said = re.escape(f"valid: components from -{most:g} to {most:g}")
    with pytest.raises(InvalidScene, match=f"{field.replace('_', ' ')} of shot .*{said}"):
        body(math.nextafter(most, math.inf))


def test_other_places_and_gravity_have_one_too() -> None:
    beyond: Vector = (2.0 * FARTHEST, 0.0, 0.0)
    with pytest.raises(InvalidShape, match="piece position"):
        Piece(Sphere(1.0), beyond)
    with pytest.raises(InvalidScene, match="anchor of link l"):
        Link("l", None, Free(), BALL, MASS, anchor=beyond)
    with pytest.raises(InvalidScene, match="centre of mass"):
        Mass(1.0, beyond)
    with pytest.raises(InvalidScene, match="gravity"):
        Scene("s", (FLOOR,), gravity=(0.0, 0.0, -2.0 * HEAVIEST))
    start = rest((HAND,))
    start.positions[0, 0] = 2.0 * FARTHEST
    with pytest.raises(InvalidScene, match=r"roots of the start \[m\]"):
        Scene("s", (), (HAND,), start=start)


class Endless:
    """An object whose parts are itself, of which numpy makes an array of as many dimensions as it can."""

    def __len__(self) -> int:
        return 3

    def __getitem__(self, key: object) -> object:
        return self


@pytest.mark.parametrize("size", [
    (np.True_, np.True_, 1e6), (True, 1.0, 1.0), (Endless(), 1.0, 1.0), Endless(), ([[[[1.0]]]], 1.0, 1.0)
])
def test_truth_values_and_endless_parts_are_no_numbers_of_a_size(size: object) -> None:
    with pytest.raises(InvalidShape, match="box size"):
        Box(size)  # type: ignore[arg-type]


@pytest.mark.parametrize("vertices", [3, 2.5, True, math.inf, math.nan, -(10**40), 10**9, MOST_VERTICES + 1, "52"])
def test_a_hull_of_an_ellipsoid_has_a_number_of_vertices_that_can_be_made(vertices: object) -> None:
    with pytest.raises(InvalidShape, match="number of vertices"):
        ellipsoid_hull((0.1, 0.1, 0.1), vertices)  # type: ignore[arg-type]


def test_pieces_of_a_solid_may_come_in_an_array_and_are_still_pieces() -> None:
    with pytest.raises(InvalidScene, match="number of pieces of a solid"):
        solid(np.zeros(0), 1.0)  # type: ignore[arg-type]


def test_a_sample_of_lists_becomes_one_of_arrays() -> None:
    plain = rest((HAND,))
    made = checked(TrackerSample(0, plain.positions.tolist(), plain.rotations.tolist(), ()), (HAND,))  # type: ignore[arg-type]
    assert made.angles.dtype == made.positions.dtype == np.float64 and made.angles.shape == (0,)
    assert np.array_equal(made.rotations, plain.rotations) and isinstance(made.time, float)


@pytest.mark.parametrize("kind", [list, iter, np.array])
def test_sizes_and_radii_are_kept_as_tuples_whatever_they_come_in(kind: Callable[[list[float]], object]) -> None:
    assert Box(kind([1.0, 2.0, 3.0])).size == (1.0, 2.0, 3.0)  # type: ignore[arg-type]
    assert Ellipsoid(kind([0.1, 0.2, 0.3])).radii == (0.1, 0.2, 0.3)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", [list, iter, np.array, tuple])
def test_pairs_of_limits_are_kept_as_tuples_of_numbers_whatever_they_come_in(kind: Callable[[list[float]], object]) -> None:
    limits = SwingTwist(AXIS, AXIS, 1.0, kind([-0.5, 0.25]))  # type: ignore[arg-type]
    assert limits.twist == (-0.5, 0.25) and isinstance(limits.twist, tuple)
    sized = replace(HAND, size_range=kind([0.01, 30.0]))
    assert sized.size_range == (0.01, 30.0) and isinstance(sized.size_range, tuple)
    assert all(type(bound) is float for bound in (*limits.twist, *sized.size_range))
