"""Checks at the door: every error names the thing, its value and the valid range."""

import math

import numpy as np
import pytest

from avatarsim.errors import InvalidScene, InvalidShape
from avatarsim.scene.checks import distinct, finite_array, positive, unit_quaternion, unit_vector, vector, within

BAD_NUMBERS = [0.0, -1.0, math.nan, math.inf, -math.inf, "1", None]


def names_all(error: pytest.ExceptionInfo[Exception], *parts: object) -> None:
    """The message holds every part."""
    for part in parts:
        assert str(part) in str(error.value)


@pytest.mark.parametrize("value", BAD_NUMBERS)
def test_positive_refuses_all_but_finite_numbers_above_0(value: object) -> None:
    with pytest.raises(InvalidShape) as error:
        positive("radius of the ball", value, InvalidShape)
    names_all(error, "radius of the ball", repr(value), "a finite number above 0")
    assert (error.value.thing, error.value.valid) == ("radius of the ball", "a finite number above 0")
    assert error.value.value is value


def test_positive_takes_ints_and_numpy_floats() -> None:
    assert positive("x", 3) == 3.0 and positive("x", np.float32(0.5)) == 0.5


@pytest.mark.parametrize("value", [-0.1, 1.1, math.nan, math.inf])
def test_within_states_the_interval(value: float) -> None:
    with pytest.raises(InvalidScene) as error:
        within("restitution", value, 0.0, 1.0)
    names_all(error, "restitution", repr(value), "from 0 to 1")


def test_within_includes_its_ends() -> None:
    assert within("x", 0.0, 0.0, 1.0) == 0.0 and within("x", 1.0, 0.0, 1.0) == 1.0


@pytest.mark.parametrize(("value", "part"), [
    ([[1.0, 2.0]], "(1, 2)"), ([1.0, 2.0, 3.0], "(3,)"), ([[1.0, math.nan, 0.0]], "finite numbers"), ([["a", 1, 2]], "'a'"),
])
def test_finite_array_says_what_is_wrong(value: object, part: str) -> None:
    with pytest.raises(InvalidScene) as error:
        finite_array("corners", value, (-1, 3))
    names_all(error, "corners", part)


def test_finite_array_copies() -> None:
    given = np.ones((2, 3))
    kept = finite_array("corners", given, (-1, 3))
    given[:] = 7.0
    assert (kept == 1.0).all()


def test_unit_vector_scales_and_refuses_zero() -> None:
    assert unit_vector("axis", (0.0, 3.0, 4.0)) == pytest.approx((0.0, 0.6, 0.8))
    with pytest.raises(InvalidScene) as error:
        unit_vector("axis of the elbow", (0.0, 0.0, 0.0))
    names_all(error, "axis of the elbow", "[0.0, 0.0, 0.0]", "non-zero length")


@pytest.mark.parametrize("value", [(2.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), (1.0, 0.01, 0.0, 0.0), (math.nan, 0.0, 0.0, 0.0)])
def test_quaternions_of_another_length_are_refused(value: tuple[float, ...]) -> None:
    with pytest.raises(InvalidScene) as error:
        unit_quaternion("orientation of box", value)
    names_all(error, "orientation of box", value[0])


def test_single_precision_quaternions_are_normalised() -> None:
    rough = np.array([0.5, 0.5, 0.5, 0.5], dtype=np.float32) * np.float32(1 + 3e-7)
    assert np.linalg.norm(unit_quaternion("q", rough)) == pytest.approx(1.0, abs=1e-15)


def test_distinct_names_the_one_that_repeats() -> None:
    distinct("body", ["a", "b"])
    with pytest.raises(InvalidScene) as error:
        distinct("body of the scene", ["a", "b", "b"])
    names_all(error, "body of the scene", "'b'", "once")


@pytest.mark.parametrize("value", [
    np.array(["1", "2"]), np.array([1j, 0.0, 0.0]), np.ma.masked_array([0.0, 0.0, 1.0], mask=[False, True, False]),
    np.array([1, 2, "x"], dtype=object), b"abc", [None] * 3,
])
def test_arrays_hold_real_numbers(value: object) -> None:
    with pytest.raises(InvalidScene, match="v is .*; valid: real numbers of shape"):
        finite_array("v", value, (3,))


@pytest.mark.parametrize("value", [
    (1, 2, 3), np.array([1, 2, 3]), np.float32([1, 2, 3]), [np.int8(1), 2.0, np.float64(3)], range(1, 4),
])
def test_any_real_numbers_will_do(value: object) -> None:
    assert vector("v", value) == (1.0, 2.0, 3.0)
