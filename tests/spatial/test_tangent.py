"""Rotations inside kernels against scipy's, near no turn, near half a turn, and anywhere."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.spatial.tangent import (
    about,
    columns,
    product,
    put_columns,
    rotation_vector,
    step_between,
    stepped,
    straightened,
    turned,
    turned_back,
)

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
SEEDS = st.integers(0, 100_000)
ANGLES = [0.0, 1e-15, 1e-12, 1e-8, 1e-4, 0.5, 2.0, np.pi - 1e-4, np.pi - 1e-8, np.pi - 1e-12]
AXES = np.vstack([np.eye(3), -np.eye(3), [[0.6, 0.8, 0.0], [0.36, -0.48, 0.8], [-0.48, 0.6, -0.64]]])


def tuples(matrix: np.ndarray) -> tuple:
    """Return columns of a matrix as tuples of floats."""
    return tuple(tuple(float(v) for v in column) for column in matrix.T)


def matrix(c: tuple) -> np.ndarray:
    """Return the matrix of three columns."""
    return np.array(c).T


def vec(v: np.ndarray) -> tuple:
    """Return three floats."""
    return tuple(float(x) for x in v)


@given(SEEDS)
def test_products_and_turns(seed: int) -> None:
    a, b = Rotation.random(2, rng=seed).as_matrix()
    v = np.random.default_rng(seed).normal(size=3)
    assert matrix(product(tuples(a), tuples(b))) == pytest.approx(a @ b, abs=1e-14)
    assert turned(tuples(a), vec(v)) == pytest.approx(a @ v, abs=1e-14)
    assert turned_back(tuples(a), vec(v)) == pytest.approx(a.T @ v, abs=1e-14)


def test_columns_are_put_where_they_were_read() -> None:
    many = Rotation.random(3, rng=1).as_matrix()
    copy = np.zeros_like(many)
    for k in range(3):
        put_columns(copy, k, columns(many, k))
    assert (copy == many).all()
    assert matrix(columns(many, 2)) == pytest.approx(many[2], abs=0.0)


@given(SEEDS, st.floats(-50.0, 50.0))
def test_about_an_axis(seed: int, angle: float) -> None:
    rng = np.random.default_rng(seed)
    axis, v = rng.normal(size=3), rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    assert about(vec(axis), angle, vec(v)) == pytest.approx(Rotation.from_rotvec(axis * angle).apply(v), abs=1e-12)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("axis", AXES)
def test_rotation_vectors_at_every_branch(axis: np.ndarray, angle: float) -> None:
    found = np.array(rotation_vector(tuples(Rotation.from_rotvec(axis * angle).as_matrix())))
    assert found == pytest.approx(axis * angle, abs=2e-8 if angle > 3.0 else 1e-14, rel=1e-9)
    # near half a turn the matrix holds the angle to rounding's square root only in a small part; the length is exact
    assert np.linalg.norm(found) == pytest.approx(angle, abs=1e-14 + 1e-9 * angle)


@pytest.mark.parametrize("axis", AXES)
def test_half_a_turn_has_either_sign(axis: np.ndarray) -> None:
    exact = 2.0 * np.outer(axis, axis) - np.eye(3)
    found = np.array(rotation_vector(tuples(exact)))
    assert np.linalg.norm(found) == pytest.approx(np.pi) and np.linalg.norm(np.cross(found, axis)) < 1e-12


@given(SEEDS, st.sampled_from([1e-13, 1e-9, 1e-3, 1.0, 3.1]))
def test_a_step_leads_where_the_step_between_says(seed: int, length: float) -> None:
    rng = np.random.default_rng(seed)
    start = Rotation.random(rng=seed).as_matrix()
    w = rng.normal(size=3)
    w *= length / np.linalg.norm(w)
    end = stepped(tuples(start), vec(w))
    assert matrix(end) == pytest.approx(start @ Rotation.from_rotvec(w).as_matrix(), abs=1e-14)
    assert step_between(tuples(start), end) == pytest.approx(w, abs=1e-13)


def test_no_step_changes_no_bit() -> None:
    start = tuples(Rotation.random(rng=5).as_matrix())
    assert stepped(start, (0.0, 0.0, 0.0)) == start


@given(SEEDS, st.floats(0.0, 1e-3))
def test_straightened_is_a_rotation_near_by(seed: int, size: float) -> None:
    exact = Rotation.random(rng=seed).as_matrix()
    bent = exact + size * np.random.default_rng(seed).uniform(-1.0, 1.0, (3, 3))
    found = matrix(straightened(tuples(bent)))
    assert found.T @ found == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(found) == pytest.approx(1.0)
    assert np.abs(found - exact).max() <= 6.0 * size + 1e-15


def test_thousands_of_steps_stay_a_rotation() -> None:
    frame, rng = tuples(np.eye(3)), np.random.default_rng(2)
    for w in rng.normal(size=(2_000, 3)):
        frame = straightened(stepped(frame, vec(w)))
    assert matrix(frame).T @ matrix(frame) == pytest.approx(np.eye(3), abs=1e-15)
