"""Avatars are trees: parents first, one root, free joints at the root only, names known."""

import math

import pytest

from avatarsim.errors import InvalidScene
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint, Rigid
from avatarsim.scene.shape import Piece, Sphere

BALL = (Piece(Sphere(0.1)),)
MASS = solid(BALL, 1.0)
AXIS = (1.0, 0.0, 0.0)


def link(name: str, parent: str | None, joint: Joint | None = None) -> Link:
    """A ball on a joint."""
    return Link(name, parent, joint or (Free() if parent is None else Ball()), BALL, MASS)


ROOT = link("root", None)


@pytest.mark.parametrize(
    ("links", "part"),
    [
        ((), "number of links of avatar a is 0"),
        ((ROOT, link("root", "root")), "link of avatar a is 'root'; valid: names that occur once only"),
        ((ROOT, link("b", None)), "parent of link b is None"),
        ((link("b", "root"), ROOT), "parent of link b"),
        ((ROOT, link("b", "c"), link("c", "root")), "parent of link b is 'c'; valid: an earlier link"),
        ((ROOT, link("b", "b")), "parent of link b is 'b'"),
        ((ROOT, link("b", "root", Free())), "joint of link b is 'Free'"),
    ],
)
def test_what_is_no_tree_is_refused(links: tuple[Link, ...], part: str) -> None:
    with pytest.raises(InvalidScene) as error:
        Avatar("a", links)
    assert part in str(error.value)


def test_chains_and_ignored_pairs_name_links() -> None:
    with pytest.raises(InvalidScene, match="chains or ignore of a is 'hand'"):
        Avatar("a", (ROOT,), chains=("hand",))
    with pytest.raises(InvalidScene, match="chains or ignore of a is 'hand'"):
        Avatar("a", (ROOT,), ignore=(("root", "hand"),))


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan])
def test_coupled_mass_is_positive(value: float) -> None:
    with pytest.raises(InvalidScene, match="coupled mass of a"):
        Avatar("a", (ROOT,), coupled_mass=value)


def test_links_check_anchor_and_orientation() -> None:
    with pytest.raises(InvalidScene, match="anchor of link b"):
        Link("b", None, Free(), BALL, MASS, anchor=(math.nan, 0.0, 0.0))
    with pytest.raises(InvalidScene, match="orientation of link b"):
        Link("b", None, Free(), BALL, MASS, orientation=(0.0, 0.0, 0.0, 2.0))


def test_hinges_are_counted_over_all_links() -> None:
    hinged = Hinges((Hinge(AXIS), Hinge(AXIS)))
    assert Avatar("a", (ROOT, link("b", "root", hinged), link("c", "b"), link("d", "c", Hinges((Hinge(AXIS),))))).hinge_count == 3
    assert rigid_avatar("hand", BALL, MASS).hinge_count == 0
    assert Avatar("post", (link("base", None, Rigid()),)).hinge_count == 0


def test_a_human_of_nearly_two_kilometres_is_refused_unless_it_is_meant() -> None:
    giant = Link("root", None, Free(), (Piece(Sphere(850.0)),), MASS)
    with pytest.raises(InvalidScene, match=r"span \[m\] of avatar a .* is 1700.0; valid: a finite number from 0.01 to 20"):
        Avatar("a", (giant,))
    assert Avatar("a", (giant,), size_range=(1000.0, 2000.0)).span == 1700.0


def test_the_span_adds_up_limbs() -> None:
    arm = Link("b", "root", Ball(), BALL, MASS, anchor=(0.0, 0.5, 0.0))
    assert math.isclose(Avatar("a", (ROOT, arm)).span, 2.0 * (0.5 + 0.1))


def test_a_hinge_alone_is_no_joint() -> None:
    """It would be taken for a ball without limits."""
    with pytest.raises(InvalidScene, match="joint of link finger is Hinge"):
        link("finger", "root", Hinge(AXIS, -1.0, 1.0))  # type: ignore[arg-type]
    with pytest.raises(InvalidScene, match="hinges of a joint, entry 0 is "):
        Hinges((AXIS,))  # type: ignore[arg-type]
