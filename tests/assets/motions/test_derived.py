"""Quantities derived from a pose: carriers of bodies missing in a model, and speeds of uniform turns."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.assets.motions.derived import Poses, carrier, is_like, links_of, spins
from avatarsim.spatial import rotation
from tests.assets.motions.robots import robot, walk


def links(frames: int = 30) -> Poses:
    model = robot()
    return links_of(model, model.coordinates.motion(walk(frames), np.arange(frames) / 50.0))


def test_of_links_that_stay_still_the_nearest_carries() -> None:
    poses = links()
    still = Poses(np.repeat(poses.places[:1], 30, axis=0), np.repeat(poses.turns[:1], 30, axis=0))
    for link in range(6):
        assert carrier(still, still.places[:, link] + 0.001, still.turns[:, link]) == link


@given(st.floats(-3.0, 3.0), st.floats(0.01, 3.0), st.integers(2, 9))
def test_an_even_turn_has_one_speed(about: float, speed: float, frames: int) -> None:
    axis = np.array([np.cos(about), np.sin(about), 0.5])
    axis /= np.linalg.norm(axis)
    times = np.arange(frames) / 30.0
    turns = rotation.from_axis_angle(np.tile(axis, (frames, 1)), speed * times)
    assert np.allclose(spins(turns, times), speed * axis, atol=1e-9)
    assert np.allclose(spins(-turns, times), speed * axis, atol=1e-9)


def test_another_convention_is_not_taken_for_ours() -> None:
    speeds = np.random.default_rng(0).normal(size=(50, 3))
    assert is_like(speeds, speeds + 0.05)
    for other in (speeds[:, [1, 2, 0]], 2.0 * speeds, speeds[:-1], np.full((50, 3), np.nan), speeds.astype(int)):
        assert not is_like(speeds, other)
