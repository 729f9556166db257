"""Postures by names, quaternions of other programs and capsules between points, as a user of the package makes them."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.spatial.transform import Rotation

import avatarsim as av
from avatarsim.errors import InvalidSample, InvalidShape, UnknownName
from avatarsim.spatial import rotation

BALL = (av.Piece(av.Sphere(0.05)),)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def tree(name: str) -> av.Avatar:
    """Return a free root, a ball, two hinges, a slide that follows the first of them, and a rigid tip."""
    joints: dict[str, av.Free | av.Ball | av.Hinges | av.Slide | av.Rigid] = {
        "root": av.Free(), "neck": av.Ball(), "wrist": av.Hinges((av.Hinge(X, -2.0, 2.0), av.Hinge(Y, -2.0, 2.0))),
        "jaw": av.Slide(X, -1.0, 1.0), "tip": av.Rigid(),
    }
    parents: tuple[str | None, ...] = (None, *joints)
    links = [
        av.Link(own, parent, joint, BALL, av.solid(BALL, 1.0), anchor=(0.0, 0.0, 0.1))
        for (own, joint), parent in zip(joints.items(), parents, strict=False)
    ]
    return av.Avatar(name, tuple(links), couplings=(av.Coupling(2, 0, 0.5),))


def test_joints_go_where_their_names_say_and_all_others_stay() -> None:
    turned = (0.0, 1.0, 0.0, 0.0)
    avatars = (tree("left"), av.rigid_avatar("fist", BALL, av.solid(BALL, 1.0)), tree("right"))
    sample = av.posed(avatars, {
        "right/wrist": (0.4, -0.2), "right/neck": turned, "left/root": ((1.0, 2.0, 3.0), turned),
        "fist": ((0.0, 0.0, 5.0), UPRIGHT),
    })
    assert sample.angles.tolist() == [0.0, 0.0, 0.0, 0.4, -0.2, 0.2]
    assert sample.positions[0].tolist() == [1.0, 2.0, 3.0] and sample.positions[5].tolist() == [0.0, 0.0, 5.0]
    assert [k for k, row in enumerate(sample.rotations.tolist()) if row == list(turned)] == [0, 7]
    further = av.posed(avatars, {"left/wrist": (0.1, 0.2)}, start=sample)
    assert further.angles.tolist() == [0.1, 0.2, 0.05, 0.4, -0.2, 0.2]
    assert np.array_equal(further.rotations, sample.rotations) and sample.angles[0] == 0.0, "the start is left as it was"


def test_own_name_of_a_link_is_enough_where_no_other_has_it() -> None:
    alone = av.posed((tree("left"),), {"wrist": (0.3, 0.0)})
    assert alone.angles[0] == 0.3
    with pytest.raises(UnknownName, match="left/wrist"):
        av.posed((tree("left"), tree("right")), {"wrist": (0.3, 0.0)})


def test_a_name_that_is_misspelt_brings_those_most_like_it() -> None:
    with pytest.raises(UnknownName, match="c/wrist") as caught:
        av.posed([tree(name) for name in "abcdefgh"], {"c/wirst": (0.3, 0.0)})
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize(("name", "value"), [
    ("wrist", 0.1), ("wrist", (0.1, float("nan"))), ("neck", (2.0, 0.0, 0.0, 0.0)), ("neck", (1.0, 0.0, 0.0)),
    ("root", (0.0, 0.0, 1.0)), ("tip", 0.1), ("jaw", 0.1), ("wrist", "far"),
])
def test_values_that_do_not_fit_a_joint_are_refused_by_its_name(name: str, value: object) -> None:
    with pytest.raises(InvalidSample, match=name):
        av.posed((tree("left"),), {name: value})  # type: ignore[dict-item]


def test_quaternions_of_scipy_turn_the_same_vectors() -> None:
    turns = Rotation.random(50, random_state=3)
    point = np.array([0.3, -0.2, 0.9])
    assert rotation.rotate(av.from_xyzw(turns.as_quat()), point) == pytest.approx(turns.apply(point), abs=1e-14)


QUATERNIONS = arrays.arrays(
    np.float64, arrays.array_shapes(min_dims=0, max_dims=3, max_side=3).map(lambda shape: (*shape, 4)),
    elements=st.floats(-100.0, 100.0),
)


@given(QUATERNIONS)
def test_from_xyzw_takes_any_leading_shape(q: np.ndarray) -> None:
    assume((np.abs(q).max(axis=-1) > 1e-3).all())
    found = av.from_xyzw(q)
    assert found.shape == q.shape and np.linalg.norm(found, axis=-1) == pytest.approx(1.0, abs=1e-14)
    lengths = np.linalg.norm(q, axis=-1)
    assert found[..., 0] * lengths == pytest.approx(q[..., 3])
    assert found[..., 1:] * lengths[..., None] == pytest.approx(q[..., :3])


def test_quaternions_of_length_1_keep_their_bits() -> None:
    q = av.from_xyzw(Rotation.random(200, random_state=4).as_quat())
    assert np.array_equal(av.from_xyzw(q[:, [1, 2, 3, 0]]), q)


@pytest.mark.parametrize("q", [
    [0.0, 0.0, 0.0], 1.0, [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0]], [0.0, float("nan"), 0.0, 1.0],
    [0.0, 0.0, float("inf"), 1.0], "up", [True, False, False, False], [1j, 0.0, 0.0, 1.0],
])
def test_arrays_that_are_no_quaternions_are_refused(q: object) -> None:
    with pytest.raises(InvalidSample):
        av.from_xyzw(q)  # type: ignore[arg-type]


POINTS = st.tuples(*[st.floats(-10.0, 10.0)] * 3)


@given(POINTS, POINTS, st.floats(0.001, 1.0))
def test_ends_of_a_capsule_are_its_points(a: tuple[float, float, float], b: tuple[float, float, float], radius: float) -> None:
    assume(np.linalg.norm(np.subtract(b, a)) > 1e-5)
    piece = av.capsule_between(a, b, radius)
    assert isinstance(piece.shape, av.Capsule) and piece.shape.radius == radius
    half = rotation.rotate(piece.orientation, (0.0, 0.0, 0.5 * piece.shape.length))
    assert np.subtract(piece.position, half) == pytest.approx(a, abs=1e-12)
    assert np.add(piece.position, half) == pytest.approx(b, abs=1e-12)


@pytest.mark.parametrize(("a", "b", "radius"), [
    ((1.0, 2.0, 3.0), (1.0, 2.0, 3.0), 0.1), ((0.0, 0.0, 0.0), (0.0, 1.0), 0.1), ((0.0, 0.0, float("nan")), X, 0.1), (X, Y, 0.0),
    (X, Y, -1.0), (X, (1e9, 0.0, 0.0), 0.1), (X, "up", 0.1),
])
def test_a_capsule_that_is_none_is_refused(a: object, b: object, radius: float) -> None:
    with pytest.raises(InvalidShape):
        av.capsule_between(a, b, radius)  # type: ignore[arg-type]
