"""Frames of preset `default` under the eyes of the judge, over motions drawn at random."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.engine import FrameRecord, Settings
from avatarsim.ik.motion_budget import SLACK
from avatarsim.scene.joint import Ball, Free, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.settings import PostureSettings
from avatarsim.simulator import AvatarsimEngine
from tests.ik.scenes import SCENES, both_hands, drawn, free_hinged, posed
from tests.stability.hostile import DT
from tests.worlds.ride import Ride, ride

SETTINGS = PostureSettings()


Ways = tuple[list[Any], list[np.ndarray]]
"""Per link the turn of its joint against its parent, as a rotation or as angles of hinges; per root its place."""


def turns_and_moves(scene: Scene, positions: np.ndarray, orientations: np.ndarray, angles: np.ndarray) -> Ways:
    """Return turns of joints and places of roots."""
    turned, moved, start, hinge = list[Any](), list[np.ndarray](), 0, 0
    rotations = Rotation.from_quat(orientations, scalar_first=True)
    for avatar in scene.avatars:
        index = {link.name: start + k for k, link in enumerate(avatar.links)}
        for link in avatar.links:
            if isinstance(link.joint, Free):
                moved.append(positions[index[link.name]])
                turned.append(rotations[index[link.name]])
            elif isinstance(link.joint, Ball) and link.parent is not None:
                turned.append(rotations[index[link.parent]].inv() * rotations[index[link.name]])
            elif isinstance(link.joint, Hinges):
                turned.append(angles[hinge : hinge + len(link.joint.hinges)])
                hinge += len(link.joint.hinges)
        start += len(avatar.links)
    return turned, moved


def change(one: Any, other: Any) -> float:
    """Return the turn of a joint [rad]."""
    if isinstance(one, Rotation):
        return float((one.inv() * other).magnitude())
    return float(np.linalg.norm(np.subtract(other, one)))


class Budgeted:
    """Compares the shown motion from frame to frame with the target's own."""

    def __init__(self, go: Ride, start: TrackerSample) -> None:
        self.go, self.shown, self.target = go, self.of_record(go, go.record), self.of_sample(go, start)

    @staticmethod
    def of_record(go: Ride, record: FrameRecord) -> Ways:
        """Return the shown positions and turns."""
        first = len(go.scene.bodies)
        return turns_and_moves(go.scene, record.shown.positions[first:], record.shown.orientations[first:], record.angles)

    @staticmethod
    def of_sample(go: Ride, sample: TrackerSample) -> Ways:
        """Return where the tracker is."""
        return turns_and_moves(go.scene, *link_poses(go.scene.avatars, sample), sample.angles)

    def frame(self, sample: TrackerSample, dt: float = DT) -> None:
        """Run one frame: its turns and moves are within the target's own motion and the catch-up speeds."""
        record = self.go.frame(sample, dt)
        shown, target = self.of_record(self.go, record), self.of_sample(self.go, sample)
        for now, before, own, own_before in zip(shown[0], self.shown[0], target[0], self.target[0], strict=True):
            most = change(own_before, own) + SETTINGS.catch_up_turn * dt * (1.0 + SLACK)
            assert change(before, now) <= most + 1e-9
        for now, before, own, own_before in zip(shown[1], self.shown[1], target[1], self.target[1], strict=True):
            most = float(np.linalg.norm(own - own_before)) + SETTINGS.catch_up_move * dt * (1.0 + SLACK)
            assert np.linalg.norm(now - before) <= most + 1e-9
        self.shown, self.target = shown, target


@pytest.mark.parametrize("name", SCENES)
@settings(max_examples=12)
@given(seed=st.integers(0, 10**6), dt=st.sampled_from((1 / 30, 1 / 60, 1 / 90, 1 / 240)))
def test_drawn_motion_is_free_within_limits_and_budgets(name: str, seed: int, dt: float) -> None:
    scene = SCENES[name]
    go = ride(scene)
    budgeted = Budgeted(go, scene.first_sample)
    for sample in drawn(scene, seed, 25):
        budgeted.frame(sample, dt)


@settings(max_examples=20)
@given(seed=st.integers(0, 10**6))
def test_a_free_target_is_reached_in_one_frame_however_far(seed: int) -> None:
    scene, rng = free_hinged(), np.random.default_rng(seed)
    go = ride(scene)
    for _ in range(12):
        # within this spread the feet keep apart
        sample = posed(scene, rng, spread=0.04, room=5.0)
        go.frame(sample)
        assert go.error(sample) < 1e-9


def records(scene: Scene, samples: Sequence[TrackerSample], **options: object) -> Iterator[FrameRecord]:
    """Yield the records of an engine of its own."""
    with AvatarsimEngine() as engine:
        engine.load(scene, Settings("default", options), DT)
        for sample in samples:
            yield engine.advance(sample, DT)


@pytest.mark.parametrize("name", SCENES)
def test_the_same_motion_gives_the_same_bits(name: str) -> None:
    samples = list(drawn(SCENES[name], 4, 40))
    first, second = (list(records(SCENES[name], samples)) for _ in range(2))
    assert [one.state_hash() for one in first] == [other.state_hash() for other in second]
    assert [dict(one.counts) for one in first] == [dict(other.counts) for other in second]


@pytest.mark.parametrize("work", [1, 10, 60])
@pytest.mark.parametrize("name", SCENES)
def test_a_frame_out_of_work_says_so_and_is_free(name: str, work: int) -> None:
    scene = SCENES[name]
    go, said = ride(scene, work=work), 0
    for sample in drawn(scene, 3, 30):
        said += go.frame(sample).statuses.get("out_of_work", 0)
    assert said > 0 or work > 10 or name == "hand"


def test_work_that_suffices_is_not_spent() -> None:
    for sample, record in zip(samples := list(drawn(SCENES["hand"], 3, 30)), records(SCENES["hand"], samples), strict=True):
        assert "out_of_work" not in record.statuses, sample.time


def frames_together(tracks: dict[str, list[np.ndarray]], names: tuple[str, ...], **options: float) -> list[np.ndarray]:
    """Return places of the hands that are there, each before a wall of its own, when each follows its own track."""
    scene = both_hands(names)
    home = rest(scene.avatars)
    found = []
    samples = [
        replace(home, positions=np.array([tracks[name][k] for name in names])) for k in range(len(tracks[names[0]]))
    ]
    for record in records(scene, samples, **options):
        found.append(record.shown.positions[len(scene.bodies) :].copy())
    return found


def tracks(seed: int, frames: int) -> dict[str, list[np.ndarray]]:
    """Return where three hands go: two near one wall, often into each other, and one far away, which rests half of the time."""
    rng, found = np.random.default_rng(seed), dict[str, list[np.ndarray]]()
    for name, centre in (("a", (0.0, -0.1, 0.0)), ("b", (0.0, 0.1, 0.0)), ("far", (50.0, 0.0, 0.0))):
        at, places = np.array(centre) - (0.15, 0.0, 0.0), []
        for k in range(frames):
            at = at + (rng.normal(size=3) * 0.02 if name != "far" or k % 40 < 20 else 0.0)
            places.append(at + [0.02 * (k % 40) / 10.0, 0.0, 0.0] if name != "far" else at + [0.15, 0.0, 0.0])
        found[name] = places
    return found


def test_an_avatar_that_moves_on_and_on_lets_none_far_away_go_on() -> None:
    """A hand behind its wall comes free as its target rests; once several settle times have passed, it goes the rest of its way
    slower and slower, whatever else moves."""
    frames = range(400)
    places = [np.array([50.3, 0.005 * min(k, 240), 0.0]) for k in frames]
    both = {"a": [np.array([-0.2 - 0.1 * (k % 2), 0.0, 0.0]) for k in frames], "far": places}
    slow = {"catch_up_move": 0.05}
    alone, beside = (frames_together(both, names, **slow) for names in (("far",), ("a", "far")))
    assert 50.06 < alone[-1][0, 0] < 50.25, "it has come free, and is late"
    for k, shown in enumerate(beside):
        assert (shown[1] == alone[k][0]).all(), k


@pytest.mark.parametrize("seed", range(3))
def test_avatars_far_apart_get_to_the_bit_what_each_gets_alone(seed: int) -> None:
    """One before its wall, two that push each other before theirs: nothing of one island reaches the other."""
    given_tracks = tracks(seed, 120)
    whole = frames_together(given_tracks, ("a", "b", "far"))
    alone, pair = frames_together(given_tracks, ("far",)), frames_together(given_tracks, ("a", "b"))
    for k, shown in enumerate(whole):
        assert (shown[:2] == pair[k]).all(), k
        assert (shown[2:] == alone[k]).all(), k
