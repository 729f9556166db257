"""The closed form of the whole body's distance beside points drawn in it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.scene.body import solid
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.spatial import rotation
from scenarios.measure.posture.tracker_offset import body_offset, body_offsets, offsets, second_moments
from tests.scenarios.examples import arm_scene, fist_scene, resting

SIZE, AT = np.array([0.2, 0.1, 0.04]), (0.05, -0.02, 0.01)
BOX = solid((Piece(Box(tuple(SIZE)), AT),), 1.7)


def test_second_moments_are_those_of_a_box() -> None:
    np.testing.assert_allclose(second_moments(BOX), np.diag(SIZE**2 / 12.0), atol=1e-16)


def _corners_of_gauss() -> np.ndarray:
    """Two points of Gauss per edge: means of squares over the box are exact."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return np.asarray(signs * SIZE / np.sqrt(12.0) + np.array(AT))


@given(st.lists(st.floats(-1.0, 1.0), min_size=11, max_size=11))
def test_beside_points_of_the_body(numbers: list[float]) -> None:
    shift, turns = np.array(numbers[:3]), np.array(numbers[3:]).reshape(2, 4) + np.array([2.0, 0.0, 0.0, 0.0])
    shown, user = rotation.to_matrix(turns / np.linalg.norm(turns, axis=1)[:, None])
    ways = shift + _corners_of_gauss() @ (shown - user).T
    found = body_offset(BOX, shift[None], (shown - user)[None])[0]
    assert found == pytest.approx(np.sqrt((ways**2).sum(axis=1).mean()), rel=1e-9, abs=1e-9)


def test_a_shift_counts_as_it_is_and_a_turn_by_what_it_moves() -> None:
    scene, recording = fist_scene(), resting(fist_scene(), 3)
    positions, orientations = recording.positions.copy(), recording.orientations.copy()
    positions[2, 1, 1] += 0.003
    orientations[3, 1] = rotation.from_axis_angle([0.0, 0.0, 1.0], np.pi)
    found = body_offsets(replace(recording, positions=positions, orientations=orientations), scene)
    radius = scene.links[0].pieces[0].shape
    assert isinstance(radius, Sphere)
    # half a turn takes a point as far as its distance from the axis, twice: mean square 4 (2/5) R^2
    np.testing.assert_allclose(found[:, 0], [0.0, 0.003, np.sqrt(1.6) * radius.radius], atol=1e-12)


def test_links_in_their_order_and_nothing_without_frames() -> None:
    recording = resting(arm_scene(), 4)
    positions = recording.positions.copy()
    positions[1:, 1] += np.array([0.0, 0.004, 0.0])
    moved = replace(recording, positions=positions)
    found = body_offsets(moved, arm_scene())
    assert found.shape == (4, 3)
    np.testing.assert_allclose(found, offsets(moved), atol=1e-12)
