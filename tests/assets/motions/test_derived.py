"""Quantities derived from a pose: carriers of bodies missing in a model, and speeds of uniform turns."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.assets.motions.derived import Poses, carrier, is_like, links_of, spins, strays
from avatarsim.spatial import rotation
from tests.assets.motions.robots import robot, walk


def links(frames: int = 30) -> Poses:
    model = robot()
    return links_of(model, model.coordinates.motion(walk(frames), np.arange(frames) / 50.0))


def fixed_to(poses: Poses, link: int, place: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    turned = rotation.from_rotation_vector(np.array([0.3, -0.2, 0.9]))
    places = poses.places[:, link] + rotation.rotate(poses.turns[:, link], np.array(place))
    return places, rotation.multiply(poses.turns[:, link], turned)


@pytest.mark.parametrize("link", range(7))
def test_a_body_is_carried_by_the_link_that_it_is_fixed_to(link: int) -> None:
    poses = links()
    # the rigid hand and the forearm move alike; the last is the world
    equal = {4: (3, 4), 3: (3, 4)}.get(link, (link,))
    assert carrier(poses, *fixed_to(poses, link, (0.01, 0.02, 0.0))) in equal


def test_a_body_that_moves_by_itself_has_no_carrier() -> None:
    poses = links()
    places, turns = fixed_to(poses, 1, (0.0, 0.0, 0.1))
    assert carrier(poses, places + 0.1 * np.sin(np.arange(30))[:, None], turns) is None


def test_of_links_that_stay_still_the_nearest_carries() -> None:
    poses = links()
    still = Poses(np.repeat(poses.places[:1], 30, axis=0), np.repeat(poses.turns[:1], 30, axis=0))
    for link in range(6):
        assert carrier(still, *fixed_to(still, link, (0.001, 0.0, 0.0))) == link


@given(st.floats(-3.0, 3.0), st.floats(0.01, 3.0), st.integers(2, 9))
def test_an_even_turn_has_one_speed(about: float, speed: float, frames: int) -> None:
    axis = np.array([np.cos(about), np.sin(about), 0.5])
    axis /= np.linalg.norm(axis)
    times = np.arange(frames) / 30.0
    turns = rotation.from_axis_angle(np.tile(axis, (frames, 1)), speed * times)
    assert np.allclose(spins(turns, times), speed * axis, atol=1e-9)
    assert np.allclose(spins(-turns, times), speed * axis, atol=1e-9)


def test_a_turn_counts_as_a_way() -> None:
    turns = rotation.from_axis_angle(np.tile([0.0, 0.0, 1.0], (2, 1)), np.array([0.0, 0.5]))
    assert strays(np.zeros((2, 3)), turns) == pytest.approx(0.05)
    assert strays(np.array([[0.0, 0.0, 0.0], [0.0, 0.3, 0.4]]), turns) == pytest.approx(0.55)


def test_another_convention_is_not_taken_for_ours() -> None:
    speeds = np.random.default_rng(0).normal(size=(50, 3))
    assert is_like(speeds, speeds + 0.05)
    for other in (speeds[:, [1, 2, 0]], 2.0 * speeds, speeds[:-1], np.full((50, 3), np.nan), speeds.astype(int)):
        assert not is_like(speeds, other)
