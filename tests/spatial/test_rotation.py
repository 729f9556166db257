"""Rotations against scipy's, near no turn, near half a turn, and anywhere."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.spatial import rotation

ANGLES = [0.0, 1e-150, 1e-12, 1e-8, 1e-4, 1.0, np.pi - 1e-4, np.pi - 1e-8, np.pi - 1e-12, np.pi]
SEEDS = st.integers(0, 100_000)


def random(seed: int, count: int = 5) -> Rotation:
    """Return some rotations."""
    return Rotation.random(count, rng=seed)


def wxyz(turn: Rotation) -> np.ndarray:
    """Return the quaternion scalar first, w >= 0."""
    return turn.as_quat(canonical=True, scalar_first=True)


def same(a: np.ndarray, b: np.ndarray, tolerance: float = 1e-12) -> None:
    """Two arrays of quaternions are the same rotations."""
    assert np.abs((a * b).sum(axis=-1)) == pytest.approx(np.ones(a.shape[:-1]), abs=tolerance)


@given(SEEDS)
def test_product_inverse_and_matrix(seed: int) -> None:
    a, b = random(seed), random(seed + 1)
    same(rotation.multiply(wxyz(a), wxyz(b)), wxyz(a * b))
    same(rotation.conjugate(wxyz(a)), wxyz(a.inv()))
    assert rotation.to_matrix(wxyz(a)) == pytest.approx(a.as_matrix(), abs=1e-14)
    same(rotation.from_matrix(a.as_matrix()), wxyz(a))


@given(SEEDS)
def test_rotate_broadcasts(seed: int) -> None:
    turns, points = random(seed), np.random.default_rng(seed).normal(size=(5, 3))
    assert rotation.rotate(wxyz(turns), points) == pytest.approx(turns.apply(points), abs=1e-13)
    assert rotation.rotate(wxyz(turns[0]), points) == pytest.approx(turns[0].apply(points), abs=1e-13)
    assert rotation.rotate(wxyz(turns), points[0]) == pytest.approx(turns.apply(points[0]), abs=1e-13)


@pytest.mark.parametrize("angle", ANGLES)
def test_rotation_vectors_to_and_fro(angle: float) -> None:
    axis = np.array([0.36, -0.48, 0.8])
    there = rotation.from_rotation_vector(angle * axis)
    assert there == pytest.approx(rotation.from_axis_angle(axis, angle), abs=1e-15)
    same(there, wxyz(Rotation.from_rotvec(angle * axis)), 1e-15)
    back = rotation.to_rotation_vector(there)
    assert np.linalg.norm(back) == pytest.approx(angle, rel=1e-9, abs=1e-300)
    if angle < np.pi:
        assert back == pytest.approx(angle * axis, rel=1e-7, abs=1e-300)
    if 0.0 < angle:
        assert np.linalg.norm(np.cross(back / np.linalg.norm(back), axis)) < 1e-9


@given(SEEDS)
def test_the_way_is_the_short_one(seed: int) -> None:
    q = wxyz(random(seed))
    for signed in (q, -q):
        vectors = rotation.to_rotation_vector(signed)
        assert (np.linalg.norm(vectors, axis=-1) <= np.pi + 1e-12).all()
        same(rotation.from_rotation_vector(vectors), q)


@pytest.mark.parametrize("axis", np.vstack([np.eye(3), -np.eye(3), [[0.6, 0.8, 0.0], [0.0, -0.6, 0.8]]]))
@pytest.mark.parametrize("angle", ANGLES)
def test_matrices_to_quaternions_at_every_branch(axis: np.ndarray, angle: float) -> None:
    turn = Rotation.from_rotvec(axis * angle)
    found = rotation.from_matrix(turn.as_matrix())
    assert found[0] >= 0.0 and np.linalg.norm(found) == pytest.approx(1.0, abs=1e-15)
    assert rotation.to_matrix(found) == pytest.approx(turn.as_matrix(), abs=1e-14)


@given(SEEDS)
def test_the_difference_of_two_turns_leads_from_one_to_the_other(seed: int) -> None:
    a, b = random(seed, 1)[0], random(seed + 1, 1)[0]
    same(rotation.turned(wxyz(a), rotation.difference(wxyz(a), -wxyz(b))), wxyz(b))


@given(SEEDS, st.floats(0.0, 1.0))
def test_slerp_goes_the_short_way_at_an_even_pace(seed: int, share: float) -> None:
    a, b = random(seed, 1)[0], random(seed + 1, 1)[0]
    between = rotation.slerp(wxyz(a), -wxyz(b), share)
    same(between, wxyz(a * Rotation.from_rotvec(share * (a.inv() * b).as_rotvec())))


@given(SEEDS, st.sampled_from([0.0, 1e-9, 1e-5, 1.0, np.pi - 1e-3, np.pi - 1e-5]))
def test_between_is_the_smallest_turn(seed: int, angle: float) -> None:
    rng = np.random.default_rng(seed)
    a, side = np.linalg.qr(rng.normal(size=(3, 2)))[0].T
    b = np.cos(angle) * a + np.sin(angle) * side
    q = rotation.between(a, b)
    assert rotation.rotate(q, a) == pytest.approx(b, abs=1e-9)
    assert np.linalg.norm(rotation.to_rotation_vector(q)) == pytest.approx(angle, abs=1e-7)


@pytest.mark.parametrize("a", np.vstack([np.eye(3), -np.eye(3), [[0.6, 0.8, 0.0]]]))
def test_between_opposites_is_half_a_turn(a: np.ndarray) -> None:
    q = rotation.between(a, -a)
    assert rotation.rotate(q, a) == pytest.approx(-a, abs=1e-12) and np.linalg.norm(q) == pytest.approx(1.0)


def test_normalised_broadcasts() -> None:
    assert rotation.normalised([[2.0, 0, 0, 0], [0, 0, -3.0, 0]]) == pytest.approx(np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0]]))


@given(SEEDS, st.integers(1, 12))
def test_continuous_quaternions_are_the_same_rotations(seed: int, count: int) -> None:
    given = np.stack([wxyz(random(seed + k, count)) for k in range(2)], axis=1)
    found = rotation.continuous(given)
    same(found, given)
    assert np.array_equal(found[0], given[0])
    assert not ((found[1:] * found[:-1]).sum(axis=-1) < 0.0).any()
    alike = rotation.continuous(found, given)
    assert np.array_equal((alike[1:] * alike[:-1]).sum(axis=-1) < 0.0, (given[1:] * given[:-1]).sum(axis=-1) < 0.0)


@given(SEEDS, st.integers(1, 30))
def test_frames_that_were_kept_have_their_own_signs(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    signs, others = rng.choice([-1.0, 1.0], size=(2, count, 1))
    recorded = signs * rotation.multiply(rotation.from_axis_angle((0.6, 0.0, 0.8), 0.4 * np.arange(count)), wxyz(random(seed, 1)))
    kept = rng.uniform(size=count) < rng.uniform()
    given = np.where(kept[:, None], recorded, others * rotation.multiply(wxyz(Rotation.from_rotvec([0.0, 0.1, 0.2])), recorded))
    found = rotation.with_signs_of(given, recorded, kept)
    same(found, given)
    assert np.array_equal(found[kept], recorded[kept])
    assert ((found * recorded).sum(axis=1) > 0.0).all()
