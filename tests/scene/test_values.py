"""Valid parts of a scene: they keep copies of their own, as tuples and unit vectors, whatever they are given."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial import ConvexHull as QuickHull

from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import ContactLaw, solid
from avatarsim.scene.joint import MANY_TURNS, Ball, Free, Hinge, Hinges, Joint, ReachCone, Rigid, SwingTwist
from avatarsim.scene.shape import Box, ConvexHull, Ellipsoid, Piece, Sphere, ellipsoid_hull

BALL = (Piece(Sphere(0.1)),)
MASS = solid(BALL, 1.0)
X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
HAND = rigid_avatar("hand", BALL, MASS)
CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])


def link(name: str, parent: str | None, joint: Joint, **more: tuple[float, ...]) -> Link:
    """Return a ball on a joint."""
    return Link(name, parent, joint, BALL, MASS, **more)  # type: ignore[arg-type]


ROOT = link("root", None, Free())


def test_hinges_are_counted_over_all_links() -> None:
    one, two = Hinges((Hinge(X),)), Hinges((Hinge(X), Hinge(X)))
    assert Avatar("a", (ROOT, link("b", "root", two), link("c", "b", Ball()), link("d", "c", one))).hinge_count == 3
    assert HAND.hinge_count == 0 and Avatar("post", (link("base", None, Rigid()),)).hinge_count == 0


def test_the_span_adds_up_limbs_and_may_be_any() -> None:
    arm = link("b", "root", Ball(), anchor=(0.0, 0.5, 0.0))
    assert math.isclose(Avatar("a", (ROOT, arm)).span, 2.0 * (0.5 + 0.1))
    giant = Link("root", None, Free(), (Piece(Sphere(850.0)),), MASS)
    assert Avatar("a", (giant,), size_range=(1000.0, 2000.0)).span == 1700.0


def test_ends_of_ranges_pass_and_quaternions_of_single_precision_become_unit_ones() -> None:
    assert (ContactLaw(0.0, 0.0).restitution, ContactLaw(1.0, 0.0).restitution) == (0.0, 1.0)
    rough: Any = np.array([0.5, 0.5, 0.5, 0.5], dtype=np.float32) * np.float32(1 + 3e-7)
    assert np.linalg.norm(Piece(Sphere(0.1), orientation=rough).orientation) == pytest.approx(1.0, abs=1e-15)


def test_hinges_may_be_locked_and_have_unit_axes() -> None:
    assert Hinge(X, 0.5, 0.5).lower == 0.5 and Hinge(X).upper == MANY_TURNS
    assert Hinge((0.0, 3.0, 4.0)).axis == pytest.approx((0.0, 0.6, 0.8))


def test_a_reach_cone_keeps_unit_vectors() -> None:
    cone = ReachCone(2.0 * np.eye(3), (1.0, 1.0, 1.0))
    assert (cone.vertices == np.eye(3)).all() and not cone.vertices.flags.writeable
    assert Ball(SwingTwist(Z, Z, 1.0, (-1.0, 1.0)), cone).cone is cone


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_thin_hulls_with_a_volume_are_kept_at_any_scale(scale: float) -> None:
    assert len(ConvexHull(CUBE * [1, 1, 1e-6] * scale).vertices) == 8


def test_a_hull_keeps_its_own_read_only_copy() -> None:
    given = CUBE.copy()
    hull = ConvexHull(given)
    given[:] = 9.0
    assert (hull.vertices == CUBE).all() and not hull.vertices.flags.writeable


@pytest.mark.parametrize("count", [4, 12, 52])
def test_an_ellipsoid_hull_is_convex_and_lies_on_the_ellipsoid(count: int) -> None:
    radii = np.array([0.3, 0.2, 0.1])
    vertices = ellipsoid_hull((0.3, 0.2, 0.1), count).vertices
    assert np.linalg.norm(vertices / radii, axis=1) == pytest.approx(np.ones(count))
    assert len(QuickHull(vertices).vertices) == count
    assert len(QuickHull(vertices).simplices) == 2 * count - 4


@pytest.mark.parametrize("kind", [list, iter, np.array, tuple])
def test_numbers_are_kept_as_tuples_whatever_they_come_in(kind: Callable[[list[float]], Any]) -> None:
    assert Box(kind([1.0, 2.0, 3.0])).size == (1.0, 2.0, 3.0)
    assert Ellipsoid(kind([0.1, 0.2, 0.3])).radii == (0.1, 0.2, 0.3)
    limits = SwingTwist(Z, Z, 1.0, kind([-0.5, 0.25]))
    sized = replace(HAND, size_range=kind([0.01, 30.0]))
    assert limits.twist == (-0.5, 0.25) and sized.size_range == (0.01, 30.0)
    assert isinstance(limits.twist, tuple) and isinstance(sized.size_range, tuple)
    assert all(type(bound) is float for bound in (*limits.twist, *sized.size_range))
