"""Time courses, speeds by key presses, and the offset that hides a change of source."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.live.drive.ease import STEEPNESS, Offset, minimum_jerk, pulse
from avatarsim.live.drive.keys import DECAY, Speeds
from avatarsim.live.drive.tree import Tree, posture_of
from avatarsim.live.stages import stage
from tests.live.drive.stages_driven import DT, excess, fastest, random_sample

share = st.floats(0.0, 1.0)


@given(share, share)
def test_a_course_ascends_and_is_no_steeper_than_stated(a: float, b: float) -> None:
    low, high = min(a, b), max(a, b)
    assert 0.0 <= minimum_jerk(low) <= minimum_jerk(high) + 1e-15 <= 1.0 + 2e-15
    assert minimum_jerk(high) - minimum_jerk(low) <= STEEPNESS * (high - low) + 1e-12


def test_a_pulse_goes_there_and_back() -> None:
    assert (pulse(0.0), pulse(0.5), pulse(1.0)) == (0.0, 1.0, 0.0)
    assert pulse(0.3) == pytest.approx(pulse(0.7))


@settings(max_examples=5)
@given(st.integers(0, 1000))
def test_an_offset_begins_at_what_was_shown_and_keeps_its_speeds(seed: int) -> None:
    scene = stage("gallery").scene
    tree = Tree(scene.avatars)
    shown, wanted = posture_of(random_sample(scene, seed)), posture_of(random_sample(scene, seed + 1))
    shown.roots[0] = (2.0, -1.0, 1.0)
    offset = Offset(tree, shown, wanted, 1.25, 4.0)
    samples = [shown.sample(0.0)]
    while offset.advance(DT):
        samples.append(offset.added(wanted).sample(0.0))
        assert len(samples) < 1000
    samples.append(wanted.sample(0.0))
    root, turn = fastest(scene, samples)
    assert root <= 1.25 * 1.001
    # a projection into a limit may add to the turn of the offset itself
    assert turn <= 2.0 * 4.0
    assert max(excess(scene, sample) for sample in samples[::10]) < 1e-6


def ticks(speeds: Speeds, seconds: float) -> None:
    """Advance time frame by frame."""
    for _ in range(round(seconds / DT)):
        speeds.advance(DT)


def test_a_press_alone_is_over_after_five_time_constants() -> None:
    speeds = Speeds()
    speeds.press("forward", 1.0)
    ticks(speeds, DECAY)
    assert 0.3 < speeds.now["forward"] < 1.0 and speeds.is_moving
    ticks(speeds, 5.0 * DECAY)
    assert speeds.now["forward"] == 0.0 and not speeds.is_moving


def test_a_repeating_key_keeps_speed_and_its_opposite_turns_it() -> None:
    speeds = Speeds()
    for _ in range(30):
        speeds.press("turn", 1.0)
        speeds.advance(DT)
    assert speeds.now["turn"] > 0.9
    speeds.press("turn", -1.0)
    ticks(speeds, DECAY)
    assert speeds.now["turn"] < 0.0
