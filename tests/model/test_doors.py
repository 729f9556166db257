"""Samples in, poses out: against the plain functions, and nothing that is not finite passes."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.model.conversion import quaternion, read_sample, write_shown
from avatarsim.model.skeleton import Posture
from avatarsim.spatial import rotation
from tests.model.test_limits import tuples

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
HINGES = np.array([7, 6, 8], dtype=np.int64)


def blank() -> Posture:
    """Return room for two links and nine degrees."""
    return Posture(np.zeros((2, 3)), np.zeros((2, 3, 3)), np.zeros(9))


def sample(seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return positions, rotations and angles of two links."""
    rng = np.random.default_rng(seed)
    return rng.normal(size=(2, 3)), rotation.normalised(rng.normal(size=(2, 4))), rng.normal(size=3)


@given(st.integers(0, 10_000))
def test_a_sample_is_read_as_the_plain_functions_read_it(seed: int) -> None:
    positions, rotations, angles = sample(seed)
    found = blank()
    assert read_sample(positions, rotations, angles, HINGES, found)
    assert (found.root == positions).all() and (found.angle[HINGES] == angles).all() and not found.angle[:6].any()
    assert found.turn == pytest.approx(rotation.to_matrix(rotations), abs=1e-14)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("which", range(3))
def test_refuses_numbers_that_are_not_finite(which: int, bad: float) -> None:
    whole = sample()
    for place in np.ndindex(whole[which].shape):
        positions, rotations, angles = arrays = [array.copy() for array in whole]
        arrays[which][place] = bad
        with np.errstate(all="ignore"):
            assert not read_sample(positions, rotations, angles, HINGES, blank())


@pytest.mark.parametrize("length", [0.0, 0.5, 1 - 2e-6, 1 + 2e-6, 2.0])
def test_quaternions_of_another_length_are_refused(length: float) -> None:
    positions, rotations, angles = sample()
    rotations[1] *= length
    with np.errstate(all="ignore"):
        assert not read_sample(positions, rotations, angles, HINGES, blank())


def test_single_precision_passes_and_gives_a_rotation() -> None:
    positions, rotations, angles = sample()
    rough = rotations.astype(np.float32).astype(np.float64)
    found = blank()
    assert read_sample(positions, rough, angles, HINGES, found)
    assert found.turn[0].T @ found.turn[0] == pytest.approx(np.eye(3), abs=1e-15)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1.0, np.pi - 1e-9, np.pi])
@pytest.mark.parametrize("axis", np.vstack([np.eye(3), -np.eye(3), [[0.36, -0.48, 0.8]]]))
def test_quaternions_of_matrices_at_every_branch(axis: np.ndarray, angle: float) -> None:
    turn = Rotation.from_rotvec(axis * angle).as_matrix()
    found: np.ndarray = np.array(quaternion(tuples(Rotation.from_matrix(turn))))
    assert found[0] >= 0.0 and np.linalg.norm(found) == pytest.approx(1.0, abs=1e-15)
    assert rotation.to_matrix(found) == pytest.approx(turn, abs=1e-14)


@given(st.integers(0, 10_000))
def test_shown_poses_undo_the_centre_of_mass(seed: int) -> None:
    rng = np.random.default_rng(seed)
    frames, turns, centres = rng.normal(size=(4, 3)), rotation.normalised(rng.normal(size=(4, 4))), rng.normal(size=(4, 3))
    positions, orientations = np.empty((4, 3)), np.empty((4, 4))
    assert write_shown(frames + rotation.rotate(turns, centres), rotation.to_matrix(turns), centres, 0, positions, orientations)
    assert positions == pytest.approx(frames, abs=1e-14)
    assert np.abs((orientations * turns).sum(axis=1)) == pytest.approx(np.ones(4), abs=1e-14)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_poses_that_are_not_finite_are_not_shown(bad: float) -> None:
    turns, positions, orientations = np.tile(np.eye(3), (2, 1, 1)), np.empty((2, 3)), np.empty((2, 4))
    place = np.zeros((2, 3))
    assert write_shown(place, turns, place, 0, positions, orientations)
    lost, bent = place.copy(), turns.copy()
    lost[1, 2] = bent[0, 1, 2] = bad
    with np.errstate(all="ignore"):
        assert not write_shown(lost, turns, place, 0, positions, orientations)
        assert not write_shown(place, bent, place, 0, positions, orientations)
