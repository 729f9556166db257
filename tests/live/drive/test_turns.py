"""Quaternions as tuples against those of numpy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.live.drive import turns
from avatarsim.spatial import rotation

number = st.floats(-3.0, 3.0)
vectors = st.tuples(number, number, number)
rotations = vectors.map(turns.exp)


@given(rotations, rotations, vectors)
def test_products_and_turned_vectors_are_those_of_arrays(
    a: tuple[float, float, float, float], b: tuple[float, float, float, float], v: tuple[float, float, float]
) -> None:
    assert np.allclose(turns.multiply(a, b), rotation.multiply(a, b), atol=1e-14)
    assert np.allclose(turns.rotate(a, v), rotation.rotate(a, v), atol=1e-13)


@given(vectors)
def test_exp_and_log_are_those_of_arrays(v: tuple[float, float, float]) -> None:
    assert np.allclose(turns.exp(v), rotation.from_rotation_vector(v), atol=1e-14)
    assert np.allclose(turns.log(turns.exp(v)), rotation.to_rotation_vector(rotation.from_rotation_vector(v)), atol=1e-12)


@given(rotations, rotations)
def test_the_way_from_one_turn_to_another_leads_there(
    a: tuple[float, float, float, float], b: tuple[float, float, float, float]
) -> None:
    reached = turns.turned_by(turns.way(a, b), a)
    assert turns.norm(turns.way(reached, b)) < 1e-12


def test_opposite_vectors_have_a_turn_between_them() -> None:
    assert np.allclose(turns.rotate(turns.between((0.0, 0.0, 1.0), (0.0, 0.0, -1.0)), (0.0, 0.0, 1.0)), (0.0, 0.0, -1.0))
