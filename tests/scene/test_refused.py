"""Values that no scene has: each is refused at once by an error that names the place, the value and the valid range."""

import math
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from avatarsim.errors import InvalidInput, InvalidSample, InvalidScene, InvalidShape
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import TABLE_1, Body, ContactLaw, Mass, PairTable, Role, fixed, solid, volume
from avatarsim.scene.checks import FARTHEST, FASTEST, FASTEST_SPIN
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint, ReachCone, SwingTwist
from avatarsim.scene.scene import HEAVIEST, Scene
from avatarsim.scene.shape import MOST_VERTICES, Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import rest
from tests.stability.hostile import hinged_avatar

Refusal = tuple[type[InvalidInput], str, Callable[[], object]]
NAN, INF = math.nan, math.inf
BALL = (Piece(Sphere(0.1)),)
MASS = solid(BALL, 1.0)
X, Z, ZERO = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
FLOOR, HAND = fixed("floor", BALL, "wood"), rigid_avatar("hand", BALL, MASS)
MASKED = np.ma.masked_array([0.0, 0.0, 1.0], mask=[False, True, False])
CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
CONE = ReachCone(np.eye(3), (1.0, 1.0, 1.0))


class Endless:
    """An object whose parts are itself, of which numpy makes an array of as many dimensions as it can."""

    def __len__(self) -> int:
        return 3

    def __getitem__(self, key: object) -> object:
        return self


def link(name: str, parent: str | None, joint: Joint | None = None) -> Link:
    """Return a ball on a joint."""
    return Link(name, parent, joint or (Free() if parent is None else Ball()), BALL, MASS)


def crate(**fields: object) -> Body:
    """Return a simulated ball with other fields."""
    return Body("crate", Role.SIMULATED, BALL, "wood", **{"mass": MASS, **fields})


def started(x: float) -> Scene:
    """Return a scene whose root starts at x."""
    start = rest((HAND,))
    start.positions[0, 0] = x
    return Scene("s", (), (HAND,), start=start)


ROOT = link("root", None)
GIANT = Link("root", None, Free(), (Piece(Sphere(850.0)),), MASS)

AVATARS: list[Refusal] = [
    (InvalidScene, "number of links of avatar a is 0", lambda: Avatar("a", ())),
    (InvalidScene, "link of avatar a is 'root'; valid: .* once only", lambda: Avatar("a", (ROOT, link("root", "root")))),
    (InvalidScene, "parent of link b is None", lambda: Avatar("a", (ROOT, link("b", None)))),
    (InvalidScene, "parent of link b", lambda: Avatar("a", (link("b", "root"), ROOT))),
    (InvalidScene, "parent of link b is 'c'; .* earlier link", lambda: Avatar("a", (ROOT, link("b", "c"), link("c", "root")))),
    (InvalidScene, "parent of link b is 'b'", lambda: Avatar("a", (ROOT, link("b", "b")))),
    (InvalidScene, "joint of link b is 'Free'", lambda: Avatar("a", (ROOT, link("b", "root", Free())))),
    (InvalidScene, "chains, ignore or at_rest of a is 'hand'", lambda: Avatar("a", (ROOT,), chains=("hand",))),
    (InvalidScene, "chains, ignore or at_rest of a is 'hand'", lambda: Avatar("a", (ROOT,), ignore=(("root", "hand"),))),
    *((InvalidScene, "coupled mass of a", partial(Avatar, "a", (ROOT,), coupled_mass=value)) for value in (0.0, -1.0, NAN)),
    (InvalidScene, r"span \[m\] of avatar a .* is 1700.0; valid: .* from 0.01 to 20", lambda: Avatar("a", (GIANT,))),
    (InvalidScene, "anchor of link b", lambda: replace(ROOT, name="b", anchor=(NAN, 0.0, 0.0))),
    (InvalidScene, "anchor of link b", lambda: replace(ROOT, name="b", anchor=(2.0 * FARTHEST, 0.0, 0.0))),
    (InvalidScene, "orientation of link b", lambda: replace(ROOT, name="b", orientation=(0.0, 0.0, 0.0, 2.0))),
    # it would be taken for a ball without limits
    (InvalidScene, "joint of link finger is Hinge", lambda: link("finger", "root", Hinge(X))),
    (InvalidScene, "mass of link l is 1.0; valid: a Mass", lambda: Link("l", None, Free(), BALL, 1.0)),
    (InvalidScene, "pieces of link l is", lambda: Link("l", None, Free(), Sphere(0.1), MASS)),
    (InvalidScene, "parent of link l is 7", lambda: Link("l", 7, Free(), BALL, MASS)),
    (InvalidScene, "name of the material of link l is None", lambda: Link("l", None, Free(), BALL, MASS, None)),
    (InvalidScene, "links of avatar a is .*valid: a tuple", lambda: Avatar("a", ROOT)),
    (InvalidScene, "chains of avatar hand is 'hand'; valid: a tuple", lambda: replace(HAND, chains="hand")),
    (InvalidScene, "ignore of avatar hand, entry 0 is 'hand'; valid: a pair", lambda: replace(HAND, ignore=("hand",))),
    (InvalidScene, "size_range of avatar hand is 1.0", lambda: replace(HAND, size_range=1.0)),
    (InvalidScene, "size_range of avatar hand is ", lambda: replace(HAND, size_range=np.array(1.0))),
    (InvalidScene, "size_range of avatar hand .* is 'small'", lambda: replace(HAND, size_range=("small", "large"))),
]

BODIES: list[Refusal] = [
    (InvalidScene, "number of pieces of body crate is 0; valid: at least 1", lambda: fixed("crate", (), "wood")),
    (InvalidScene, "mass of simulated body crate is None", lambda: crate(mass=None)),
    (InvalidScene, "mass of body crate is 1.0; valid: a Mass", lambda: crate(mass=1.0)),
    (InvalidScene, "role of body b is 'driven'; valid: fixed or simulated", lambda: Body("b", Role.DRIVEN, BALL, "wood")),
    (InvalidScene, "role of body b is 'fixed'; valid: Role.FIXED or Role.SIM", lambda: Body("b", "fixed", BALL, "wood")),
    (InvalidScene, "position of crate", lambda: crate(position=(NAN, 0.0, 0.0))),
    (InvalidScene, "position of crate", lambda: crate(position=(0.0, 0.0))),
    (InvalidScene, "orientation of crate", lambda: crate(orientation=(2.0, 0.0, 0.0, 0.0))),
    (InvalidScene, "velocity of crate", lambda: crate(velocity=(0.0, INF, 0.0))),
    (InvalidScene, "angular velocity of crate", lambda: crate(angular_velocity=(0.0, 0.0, NAN))),
    # impacts would read it, and a floor that never moves would kick for ever
    (InvalidScene, "velocity of fixed body floor .* zero", lambda: replace(FLOOR, velocity=Z)),
    (InvalidScene, "velocity of fixed body floor .* zero", lambda: replace(FLOOR, angular_velocity=Z)),
    (InvalidScene, "pieces of body b is .*valid: a tuple", lambda: fixed("b", [*BALL], "wood")),
    (InvalidScene, "pieces of body b is .*valid: a tuple", lambda: fixed("b", BALL[0], "wood")),
    (InvalidScene, r"pieces of body b, entry 0 is .*valid: a Piece\(", lambda: fixed("b", (Sphere(0.1),), "wood")),
    (InvalidScene, "name of the material of body b is 3", lambda: fixed("b", BALL, 3)),
    *((InvalidScene, r"position of b \[m\] is .*real numbers", partial(fixed, "b", BALL, "wood", value))
      for value in ((1j, 0.0, 0.0), MASKED, ("1", "2", "3"), "123", [None] * 3, (True, False, True))),
    *((InvalidScene, "mass is .* finite number above 0", partial(make, value)) for value in (0.0, -1.0, NAN, INF)
      for make in (Mass, partial(solid, BALL))),
    (InvalidScene, "centre of mass", lambda: Mass(1.0, (2.0 * FARTHEST, 0.0, 0.0))),
    *((InvalidScene, said, partial(Mass, 1.0, inertia=inertia)) for inertia, said in (
        (np.diag([1.0, 1.0, 0.0]), "principal moments.*inertia"), (np.diag([1.0, 1.0, -1.0]), "principal moments.*inertia"),
        (np.diag([1.0, 1.0, 2.1]), "inertia.*none above the sum"), (np.eye(3) + np.eye(3, k=1), "inertia.*symmetric"),
        (np.diag([1.0, 1.0, NAN]), "inertia.*finite"), (np.eye(2), r"inertia.*\(2, 2\)"),
        (np.zeros((3, 3)), "principal moments.*inertia"), (np.eye(3) * (1.0 + 0.0j), "inertia is .*real numbers"),
    )),
    *((InvalidScene, "number of pieces of a solid is 0; valid: at least 1", partial(solid, none, 1.0))
      for none in ([], np.zeros(0))),
    (InvalidScene, "pieces of a solid, entry 0", lambda: solid((Sphere(0.1),), 1.0)),
    (InvalidInput, "pieces of a solid", lambda: solid(np.array(1.0), 1.0)),
    *((InvalidScene, "shape whose volume is asked for", partial(volume, shape))
      for shape in (None, 1.0, (1.0, 2.0, 3.0), Sphere, BALL[0])),
    *((InvalidScene, "restitution is .* from 0 to 1", partial(ContactLaw, value, 0.1)) for value in (-0.01, 1.01, NAN, INF)),
    *((InvalidScene, "friction is .* from 0 to 100", partial(ContactLaw, 0.1, value)) for value in (-0.01, NAN, INF)),
    # whichever came last would win
    (InvalidScene, r"contact of n and m is .*0\.2.*; valid: that of m and n, .*0\.1",
     lambda: PairTable({("m", "n"): ContactLaw(0.5, 0.1), ("n", "m"): ContactLaw(0.5, 0.2)})),
    (InvalidScene, "contact of a and b is 0.5; valid: a ContactLaw", lambda: PairTable({("a", "b"): 0.5})),
    (InvalidScene, "pairs of a PairTable, entry 0 is 'ab'", lambda: PairTable({"ab": ContactLaw(0.1, 0.1)})),
    (InvalidScene, "pairs of a PairTable is .*valid: a mapping", lambda: PairTable([("a", "b")])),
]

JOINTS: list[Refusal] = [
    (InvalidScene, r"\(1.0, -1.0\).*lower at most upper", lambda: Hinge(X, 1.0, -1.0)),
    *((InvalidScene, f"{end} hinge limit", partial(Hinge, X, **{end: value}))
      for value in (NAN, INF, -INF, 1e6) for end in ("lower", "upper")),
    (InvalidScene, "hinge axis", lambda: Hinge(ZERO)),
    *((InvalidScene, f"number of hinges that share a centre is {count}; valid: 1 to 3", partial(Hinges, (Hinge(X),) * count))
      for count in (0, 4)),
    (InvalidScene, "hinges of a joint is Hinge.*valid: a tuple", lambda: Hinges(Hinge(X))),
    (InvalidScene, "hinges of a joint, entry 0 is ", lambda: Hinges((X,))),
    *((InvalidScene, said, partial(SwingTwist, *arguments)) for said, arguments in (
        *(("swing limit", (X, Z, swing, (0.0, 0.0))) for swing in (NAN, -0.1, 3.1)),
        ("lower at most upper", (X, Z, 1.0, (0.5, -0.5))), ("lower twist limit", (X, Z, 1.0, (-4.0, 0.0))),
        ("upper twist limit", (X, Z, 1.0, (0.0, NAN))), ("swing axis", (ZERO, Z, 1.0, (0.0, 0.0))),
        ("swing centre", (X, ZERO, 1.0, (0.0, 0.0))), (r"twist limits \[rad\] is ", (Z, Z, 1.0, np.array(0.5))),
        ("swing axis is .*real numbers", ((1j, 0.0, 0.0), Z, 1.0, (0.0, 1.0))),
    )),
    *((InvalidScene, said, partial(ReachCone, corners, seen)) for said, corners, seen in (
        ("at least 3 directions", [X, Z], X), ("at least 3 directions", [X, Z, ZERO], X), ("visible point", np.eye(3), ZERO),
        ("counter-clockwise", np.eye(3)[::-1], (1.0, 1.0, 1.0)), ("height above an edge", np.eye(3), (1.0, 1.0, -0.5)),
        ("height above an edge", np.eye(3), (1.0, 1.0, 0.0)),
        ("edge of the reach cone", [X, X, (0.0, 1.0, 0.0), Z], (1.0, 1.0, 1.0)),
        ("turns of the reach cone", [*np.eye(3), *np.eye(3)], (1.0, 1.0, 1.0)),
    )),
    (InvalidScene, "from the swing centre", lambda: Ball(SwingTwist(Z, Z, 0.5, (-1.0, 1.0)), CONE)),
    (InvalidScene, "limits of a ball joint is", lambda: Ball((0.0, 1.0))),
    (InvalidScene, "cone of a ball joint is", lambda: Ball(None, Z)),
]

SIZES: dict[str, Callable[[float], object]] = {
    "sphere radius": Sphere, "capsule radius": lambda v: Capsule(v, 1.0), "capsule length": lambda v: Capsule(1.0, v),
    "box size": lambda v: Box((1.0, v, 1.0)), "ellipsoid radi": lambda v: Ellipsoid((1.0, 1.0, v)),
}
SHAPES: list[Refusal] = [
    *((InvalidShape, f"{thing}.*{re.escape(str(value))}.*finite number", partial(make, value))
      for thing, make in SIZES.items() for value in (0.0, -0.1, NAN, INF, 1e-200, 1e9)),
    (InvalidShape, "along y", lambda: Box((1.0, 0.0, 1.0))),
    *((InvalidShape, "box size", partial(Box, size)) for size in (
        (np.True_, np.True_, 1e6), (True, 1.0, 1.0), (Endless(), 1.0, 1.0), Endless(), ([[[[1.0]]]], 1.0, 1.0))),
    *((InvalidShape, "extent of the hull.*1e-06 to 1e[+]07", partial(ConvexHull, CUBE * scale))
      for scale in (1e-200, 1e-7, 1e8, 1e200)),
    *((InvalidShape, "thickness of the hull .* flat", partial(ConvexHull, flat)) for flat in (
        CUBE * [1, 1, 0], CUBE * [1, 0, 0], CUBE * 0, CUBE * [1, 1, 1e-12], CUBE @ [[1, 0, 1], [0, 1, 1], [0, 0, 0]])),
    *((InvalidShape, said, partial(ConvexHull, vertices)) for vertices, said in (
        (CUBE[:3], "number of hull vertices is 3"), (CUBE[:, :2], r"\(8, 2\)"), ([[NAN] * 3] * 4, "finite"),
        *((what, "hull vertices is .*real numbers") for what in (np.ma.masked_array(np.eye(4, 3)), b"abc", np.array(["1"]))))),
    *((InvalidShape, "number of vertices", partial(ellipsoid_hull, (0.1, 0.1, 0.1), count)) for count in (
        3, 2.5, True, INF, NAN, -(10**40), 10**9, MOST_VERTICES + 1, "52")),
    (InvalidShape, "is 3; valid: a whole number from 4 to ", lambda: ellipsoid_hull((1.0, 1.0, 1.0), 3)),
    *((InvalidShape, "ellipsoid radi", partial(ellipsoid_hull, radii)) for radii in (
        0.1, (0.1, 0.1), (0.1, 0.1, 0.1, 0.1), (0.1, "a", 0.1), [{}, {}, []], None, (0.1, -1.0, 0.1))),
    (InvalidShape, "piece position", lambda: Piece(Sphere(1.0), (0.0, INF, 0.0))),
    (InvalidShape, "piece position", lambda: Piece(Sphere(1.0), (2.0 * FARTHEST, 0.0, 0.0))),
    (InvalidShape, "piece orientation is .*2.0.* length 1", lambda: Piece(Sphere(1.0), orientation=(2.0, 0.0, 0.0, 0.0))),
    (InvalidShape, "shape of a piece is None; valid: a Sphere, Capsule", lambda: Piece(None)),
    (InvalidShape, "shape of a piece is Piece", lambda: Piece(BALL[0])),
]

SCENES: list[Refusal] = [
    (InvalidScene, "number of bodies of scene s is 0", lambda: Scene("s")),
    (InvalidScene, "body of scene s is 'floor'; valid: .* once only", lambda: Scene("s", (FLOOR, FLOOR))),
    (InvalidScene, "'hand'", lambda: Scene("s", (fixed("hand", BALL, "wood"),), (HAND,))),
    (InvalidScene, "material of floor is 'cheese'; valid: one of human, metal, wood",
     lambda: Scene("s", (replace(FLOOR, material="cheese"),))),
    (InvalidScene, "gravity", lambda: Scene("s", (FLOOR,), gravity=(0.0, 0.0, NAN))),
    (InvalidScene, "gravity", lambda: Scene("s", (FLOOR,), gravity=(0.0, 0.0, -2.0 * HEAVIEST))),
    (InvalidScene, "name in exclude is 'roof'", lambda: Scene("s", (FLOOR,), exclude=(("floor", "roof"),))),
    (InvalidScene, "effect is 'gravity'", lambda: Scene("s", (FLOOR,), narrow=("gravity",))),
    (InvalidSample, "tracker positions", lambda: Scene("s", avatars=(HAND,), start=rest((hinged_avatar(),)))),
    (InvalidScene, r"roots of the start \[m\]", lambda: started(2.0 * FARTHEST)),
    *((InvalidScene, "name of a scene", partial(Scene, name, (FLOOR,))) for name in ("", "  ", None, 3)),
    *((InvalidScene, "name of a body", partial(fixed, name, BALL, "wood")) for name in ("", "  ", None, 3)),
    (InvalidScene, "bodies of scene s, entry 0 is .*valid: a Body", lambda: Scene("s", (HAND,))),
    (InvalidScene, "avatars of scene s, entry 0 is .*valid: an Avatar", lambda: Scene("s", (FLOOR,), (FLOOR,))),
    (InvalidScene, "bodies of scene s is .*valid: a tuple", lambda: Scene("s", [FLOOR])),
    (InvalidScene, "materials of scene s is", lambda: Scene("s", (FLOOR,), materials=dict(TABLE_1.pairs))),
    (InvalidScene, "at_rest of scene s, entry 0", lambda: Scene("s", (FLOOR,), at_rest=(("floor", "roof"),))),
    (InvalidScene, "name in at_rest of scene s is 'roof'", lambda: Scene("s", (FLOOR,), at_rest=(("floor", "roof", 0.1),))),
    (InvalidScene, "exclude of scene s, entry 0 is 'floor'", lambda: Scene("s", (FLOOR,), exclude=("floor",))),
    (InvalidScene, "narrow of scene s is 'friction'; valid: a tuple", lambda: Scene("s", (FLOOR,), narrow="friction")),
    (InvalidScene, "require of scene s, entry 0 is 1", lambda: Scene("s", (FLOOR,), require=(1,))),
    (InvalidSample, "tracker sample is 'here'; valid: a TrackerSample", lambda: Scene("s", (), (HAND,), start="here")),
]


@pytest.mark.parametrize(("error", "said", "make"), [*AVATARS, *BODIES, *JOINTS, *SHAPES, *SCENES])
def test_a_value_that_no_scene_has_is_refused(error: type[InvalidInput], said: str, make: Callable[[], object]) -> None:
    with pytest.raises(error, match=said):
        make()


@pytest.mark.parametrize(("field", "most"), [("position", FARTHEST), ("velocity", FASTEST), ("angular_velocity", FASTEST_SPIN)])
def test_the_largest_place_and_velocity_pass_and_no_larger_one(field: str, most: float) -> None:
    assert getattr(crate(**{field: (0.0, 0.0, -most)}), field) == (0.0, 0.0, -most)
    said = re.escape(f"valid: components from -{most:g} to {most:g}")
    with pytest.raises(InvalidScene, match=f"{field.replace('_', ' ')} of crate .*{said}"):
        crate(**{field: (0.0, 0.0, math.nextafter(most, INF))})
