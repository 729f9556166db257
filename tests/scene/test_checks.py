"""Checks of numbers: every error has the thing, its value and the valid range; `test_refused` tests them at every entry."""

import math

import numpy as np
import pytest

from avatarsim.errors import InvalidScene, InvalidShape
from avatarsim.scene.checks import distinct, finite_array, positive, unit_quaternion, unit_vector, vector, within


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, -math.inf, "1", None])
def test_positive_refuses_all_but_finite_numbers_above_0(value: object) -> None:
    with pytest.raises(InvalidShape) as error:
        positive("radius of the ball", value, InvalidShape)
    assert (error.value.thing, error.value.valid) == ("radius of the ball", "a finite number above 0")
    assert error.value.value is value and all(part in str(error.value) for part in ("radius of the ball", repr(value), "above 0"))


def test_other_checks_name_thing_and_value_too() -> None:
    with pytest.raises(InvalidScene, match="restitution is 1.1; .* from 0 to 1"):
        within("restitution", 1.1, 0.0, 1.0)
    with pytest.raises(InvalidScene, match=r"axis of the elbow is \[0.0, 0.0, 0.0\]; .*non-zero length"):
        unit_vector("axis of the elbow", (0.0, 0.0, 0.0))
    with pytest.raises(InvalidScene, match="body of the scene is 'b'; .*once"):
        distinct("body of the scene", ["a", "b", "b"])


def test_ends_of_ranges_and_numbers_of_any_kind_are_taken() -> None:
    assert positive("x", 3) == 3.0 and positive("x", np.float32(0.5)) == 0.5
    assert within("x", 0.0, 0.0, 1.0) == 0.0 and within("x", 1.0, 0.0, 1.0) == 1.0
    assert unit_vector("axis", (0.0, 3.0, 4.0)) == pytest.approx((0.0, 0.6, 0.8))
    for value in ((1, 2, 3), np.array([1, 2, 3]), np.float32([1, 2, 3]), [np.int8(1), 2.0, np.float64(3)], range(1, 4)):
        assert vector("v", value) == (1.0, 2.0, 3.0)


@pytest.mark.parametrize("value", [
    np.array(["1", "2"]), np.array([1j, 0.0, 0.0]), np.ma.masked_array([0.0, 0.0, 1.0], mask=[False, True, False]),
    np.array([1, 2, "x"], dtype=object), b"abc", [None] * 3,
])
def test_arrays_hold_real_numbers(value: object) -> None:
    with pytest.raises(InvalidScene, match="v is .*; valid: real numbers of shape"):
        finite_array("v", value, (3,))


@pytest.mark.parametrize("value", [(0.0, 0.0, 0.0, 0.0), (1.0, 0.01, 0.0, 0.0), (math.nan, 0.0, 0.0, 0.0)])
def test_quaternions_of_another_length_are_refused(value: tuple[float, ...]) -> None:
    with pytest.raises(InvalidScene, match=f"orientation of box is .*{value[0]}"):
        unit_quaternion("orientation of box", value)


def test_single_precision_quaternions_are_normalised() -> None:
    rough = np.array([0.5, 0.5, 0.5, 0.5], dtype=np.float32) * np.float32(1 + 3e-7)
    assert np.linalg.norm(unit_quaternion("q", rough)) == pytest.approx(1.0, abs=1e-15)
