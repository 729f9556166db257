"""Recorded motions: frames come back as they were recorded, between them joints turn evenly, and other files are refused."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.errors import InvalidInput
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation


def motion(frames: int, seed: int = 0, links: int = 3, hinges: int = 2, rate: float = 30.0) -> Motion:
    rng = np.random.default_rng(seed)
    return Motion(
        np.arange(frames) / rate, rng.normal(size=(frames, links, 3)), rotation.normalised(rng.normal(size=(frames, links, 4))),
        rng.normal(size=(frames, hinges)),
    )


def parts(one: Motion) -> dict[str, Any]:
    return {name: getattr(one, name) for name in ("times", "positions", "rotations", "angles")}


def turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.linalg.norm(rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(a), b)), axis=-1)


@given(st.integers(2, 12), st.integers(1, 5), st.integers(0, 99), st.sampled_from([24.0, 30.0, 50.0, 120.0, 29.97]))
def test_finer_frames_keep_recorded_ones_to_the_bit(frames: int, times: int, seed: int, rate: float) -> None:
    recorded = motion(frames, seed, rate=rate)
    fine = recorded.resampled(rate * times)
    assert len(fine) == (frames - 1) * times + 1
    for name in ("positions", "rotations", "angles"):
        assert (getattr(fine, name)[::times] == getattr(recorded, name)).all()
    assert np.abs(fine.times[::times] - recorded.times).max() < 1e-12


@given(st.integers(2, 12), st.floats(1.0, 200.0), st.integers(0, 99))
def test_resampled_steps_are_equal_and_end_in_time(frames: int, rate: float, seed: int) -> None:
    recorded = motion(frames, seed)
    other = recorded.resampled(rate)
    assert np.allclose(np.diff(other.times), 1.0 / rate)
    assert recorded.times[-1] - 1.0 / rate - 1e-9 < other.times[-1] <= recorded.times[-1] + 1e-9 / rate * 30.0
    assert np.allclose(np.linalg.norm(other.rotations, axis=2), 1.0, atol=1e-12)


@given(st.integers(0, 99), st.floats(0.0, 1.0))
def test_between_frames_joints_turn_evenly(seed: int, share: float) -> None:
    recorded = motion(2, seed)
    sample = recorded.between(0, share)
    whole, part = turn(recorded.rotations[0], recorded.rotations[1]), turn(recorded.rotations[0], sample.rotations)
    assert np.allclose(part, share * whole, atol=1e-7)
    assert np.allclose(sample.angles, (1.0 - share) * recorded.angles[0] + share * recorded.angles[1])
    assert np.allclose(sample.positions, (1.0 - share) * recorded.positions[0] + share * recorded.positions[1])
    assert sample.time == pytest.approx(share / 30.0)


def test_between_is_what_finer_frames_show() -> None:
    recorded = motion(4)
    fine = recorded.resampled(120.0)
    for frame in range(3):
        for k in range(4):
            sample, shown = recorded.between(frame, k / 4.0), fine.sample(4 * frame + k)
            assert turn(sample.rotations, shown.rotations).max() < 1e-9
            assert np.allclose(sample.angles, shown.angles) and np.allclose(sample.positions, shown.positions)


def test_after_the_last_frame_nothing_moves() -> None:
    recorded = motion(3)
    assert (recorded.between(2, 0.5).angles == recorded.angles[2]).all()


def test_uneven_times_are_kept_where_they_are_asked_for() -> None:
    recorded = Motion(**parts(motion(3)) | {"times": np.array([0.0, 0.1, 0.4])})
    other = recorded.resampled(10.0)
    assert (other.angles[[0, 1, 4]] == recorded.angles).all()
    assert np.allclose(other.angles[2], recorded.angles[1] + (recorded.angles[2] - recorded.angles[1]) / 3.0)
    assert recorded.rate == pytest.approx(5.0)


def test_one_frame_is_a_motion() -> None:
    still = motion(1)
    assert still.resampled(60.0) is still
    assert np.isnan(still.rate)
    assert (still.sample(0).angles == still.angles[0]).all()


def test_turns_go_the_short_way_whatever_the_sign() -> None:
    recorded = motion(2)
    flipped = Motion(**parts(recorded) | {"rotations": recorded.rotations * np.array([1.0, -1.0])[:, None, None]})
    assert turn(recorded.between(0, 0.5).rotations, flipped.between(0, 0.5).rotations).max() < 1e-9


@pytest.mark.parametrize(("name", "value", "says"), [
    ("times", np.array([0.0, 0.1, 0.1]), "not ascending"),
    ("times", np.array([0.0, 0.1]), "frames in the"),
    ("times", np.zeros((3, 1)), "shape of the times"),
    ("times", np.zeros(0), "frames in the times"),
    ("positions", np.zeros((3, 3)), "shape of the positions"),
    ("positions", np.zeros((3, 2, 3)), "shape of the rotations"),
    ("positions", np.zeros((3, 3, 2)), "shape of the positions"),
    ("rotations", np.zeros((3, 3, 3)), "shape of the rotations"),
    ("rotations", np.zeros((2, 3, 4)), "frames in the rotations"),
    ("angles", np.zeros(3), "shape of the angles"),
    ("angles", np.zeros((3, 2, 1)), "shape of the angles"),
    ("angles", np.full((3, 2), "0.5"), "angles of a motion"),
    ("angles", [[0.0, 1.0], [0.0], [1.0, 2.0]], "angles of a motion"),
    ("angles", None, "angles of a motion"),
    ("angles", np.array([[0.0, 0.0], [0.0, np.nan], [0.0, 0.0]]), "angles of frame 1"),
    ("positions", np.full((3, 3, 3), np.inf), "positions of frame 0"),
])
def test_what_is_no_motion_is_refused_by_name(name: str, value: Any, says: str) -> None:
    with pytest.raises(InvalidInput, match=says):
        Motion(**parts(motion(3)) | {name: value})


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan"), float("inf")])
def test_a_rate_that_is_none_is_refused(rate: float) -> None:
    with pytest.raises(InvalidInput, match="frames a second"):
        motion(3).resampled(rate)


def test_a_resampled_motion_has_its_most_frames() -> None:
    long = Motion(**parts(motion(2)) | {"times": np.array([0.0, 10.0])})
    assert len(long.resampled(1000.0)) == 10_001
    with pytest.raises(InvalidInput, match="frames a second") as found:
        long.resampled(1e6)
    assert found.value.value == 1e6 and "100000 for 10 s" in found.value.valid
