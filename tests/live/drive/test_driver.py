"""Postures from the user's actions: sources, their precedence, and refusals that change nothing."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.errors import InvalidInput, InvalidSample, UnknownName
from avatarsim.live.drive.driver import FASTEST, FASTEST_TURN, Driver
from avatarsim.live.stages import stage
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed, solid
from avatarsim.scene.motion import Motion
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from tests.live.drive.stages_driven import DT, driver, excess, fastest, places, random_sample, ticks

BALL = (Piece(Sphere(0.1)),)
BODY, HAND = stage("gallery").scene, stage("hand").scene


def waving() -> Motion:
    """Return a second in which the human's right arm rises and its root moves a metre ahead, from another place than its own."""
    a, b = random_sample(BODY, 5, 0.3), random_sample(BODY, 6, 0.3)
    positions = np.stack([a.positions, b.positions])
    positions[:, 0] = (-1.0, 1.0, 1.03), (0.0, 1.0, 1.03)
    return Motion(np.array([0.0, 1.0]), positions, np.stack([a.rotations, b.rotations]), np.zeros((2, 0))).resampled(30.0)


def same(a: TrackerSample, b: TrackerSample) -> bool:
    """Return True if two postures are equal to the bit."""
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in ("positions", "rotations", "angles"))


def test_nothing_done_is_the_start_and_time_passes() -> None:
    for scene in (BODY, HAND):
        one = Driver(scene)
        sample = ticks(one, 3)[-1]
        assert same(sample, scene.first_sample) and sample.time == pytest.approx(3 * DT)
        assert one.source == "still"


def everything(one: Driver, seed: int) -> list[TrackerSample]:
    """Return postures from all sources, one after the other."""
    rng, found = np.random.default_rng(seed), []
    for k in range(200):
        if k % 3 == 0 and k < 90:
            one.press("ikjluorft "[int(rng.integers(10))])
        if k == 100:
            one.drag("human/right_hand", rng.uniform(-1.0, 1.0, 3) + (-2.2, 0.0, 1.0))
        if k == 130:
            one.release("human/right_hand")
            one.play(waving(), at=(0.0, 0.0, 1.0))
        if k == 170:
            one.take_over()
            one.set_sample(random_sample(BODY, seed))
        found.append(one.tick(DT))
    return found


def test_the_same_calls_give_the_same_bits() -> None:
    first, again = everything(driver("gallery"), 1), everything(driver("gallery"), 1)
    assert all(same(a, b) for a, b in zip(first, again, strict=True))


@settings(max_examples=6)
@given(st.integers(0, 10_000))
def test_no_change_of_source_is_a_jump_and_all_is_within_limits(seed: int) -> None:
    samples = [BODY.first_sample, *everything(driver("gallery"), seed)]
    root, turn = fastest(BODY, samples)
    # a clip's own speed is added to that of the offset, and a projection into a limit to that of a joint
    assert root <= FASTEST + 1.0
    assert turn <= FASTEST_TURN + 4.0
    assert max(excess(BODY, sample) for sample in samples[::10]) < 1e-6


def test_a_root_goes_where_it_is_dragged_no_faster_than_stated() -> None:
    one = driver("hand")
    one.drag("hand/palm", (0.3, 0.1, 1.4), (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)))
    samples = [HAND.first_sample, *ticks(one, 60)]
    assert samples[-1].positions[0] == pytest.approx((0.3, 0.1, 1.4), abs=1e-12)
    assert abs(samples[-1].rotations[0] @ (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))) == pytest.approx(1.0, abs=1e-9)
    assert fastest(HAND, samples)[0] <= FASTEST * 1.001


def test_a_finger_pulled_out_of_reach_takes_the_hand_along() -> None:
    one = driver("hand")
    one.drag("hand/index3", (0.4, 0.3, 1.3))
    ticks(one, 120)
    assert np.linalg.norm(one.pose("hand/index3")[0] - (0.4, 0.3, 1.3)) < 1e-3


def test_a_human_that_is_pulled_away_by_a_hand_walks_after_it() -> None:
    one, start = driver("gallery"), places(BODY, BODY.first_sample)
    one.drag("human/left_hand", (-0.5, 0.4, 1.2))
    joints = places(BODY, ticks(one, 240)[-1])
    assert joints[0, 0] - start[0, 0] > 0.5
    assert joints[0, 2] == pytest.approx(start[0, 2], abs=0.05)
    feet = [BODY.names.index(f"human/{side}_foot") - len(BODY.bodies) for side in ("left", "right")]
    assert joints[feet, 0] - joints[0, 0] == pytest.approx(start[feet, 0] - start[0, 0], abs=0.03)


def test_precedence_is_drag_keys_clip_tracker() -> None:
    one = driver("gallery")
    one.set_sample(random_sample(BODY, 1))
    one.tick(DT)
    assert one.source == "tracker"
    one.play(waving())
    one.set_sample(random_sample(BODY, 2))
    one.tick(DT)
    assert one.source == "clip"
    assert one.press("i") == ""
    one.tick(DT)
    assert one.source == "keys"
    one.drag("human/head", one.pose("human/head")[0])
    assert "dragged" in one.press("i")
    one.tick(DT)
    assert one.source == "drag"
    one.release("human/head")
    ticks(one, 240)
    assert one.source == "still"
    one.set_sample(random_sample(BODY, 3))
    one.tick(DT)
    assert one.source == "tracker"


def test_a_tracker_is_followed_exactly_once_the_change_is_over() -> None:
    one, wanted = driver("gallery"), random_sample(BODY, 9)
    for _ in range(180):
        one.set_sample(wanted)
        shown = one.tick(DT)
    assert shown.rotations == pytest.approx(wanted.rotations, abs=1e-6)
    assert shown.positions[0] == pytest.approx(wanted.positions[0])


def test_a_clip_takes_what_it_carries_along() -> None:
    box = moving("box", BALL, "wood", position=(2.0, 0.0, 1.0))
    scene = replace(HAND, avatars=(HAND.avatars[0], box), start=None, bodies=())
    one, first = Driver(scene), scene.first_sample
    positions = np.tile(first.positions, (3, 1, 1))
    positions[1:, -1] = (2.0, 0.1, 1.0)
    motion = Motion(np.array([0.0, 0.5, 1.0]), positions, np.tile(first.rotations, (3, 1, 1)), np.tile(first.angles, (3, 1)))
    one.play(motion)
    assert ticks(one, 120)[-1].positions[-1] == pytest.approx((2.0, 0.1, 1.0))


def test_a_clip_is_played_to_its_end_and_taken_over_where_it_is() -> None:
    motion, one = waving(), driver("gallery")
    one.play(motion)
    # its first posture is farther away than the motion's second of time would allow
    samples = ticks(one, 240)
    assert samples[-1].positions[0] == pytest.approx(motion.positions[-1, 0])
    assert samples[-1].rotations == pytest.approx(motion.rotations[-1], abs=1e-6)
    one.play(motion, at=(0.0, 0.0, 1.0))
    ticks(one, 90)
    one.take_over()
    held = ticks(one, 2)
    assert same(held[0], held[1]) and one.source == "still"
    one.play(motion, at=(3.0, 0.0, 1.0))
    ticks(one, 20)
    one.take_over()
    stopped = ticks(one, 60)
    assert same(stopped[0], stopped[-1])


@pytest.mark.parametrize(("key", "axis", "sign"), [
    ("i", 0, 1.0), ("k", 0, -1.0), ("j", 1, 1.0), ("l", 1, -1.0), ("r", 2, 1.0), ("f", 2, -1.0),
])
def test_keys_move_a_hand_along_its_own_axes(key: str, axis: int, sign: float) -> None:
    moved = ticks(driver("hand"), 30, key)[-1].positions[0] - HAND.first_sample.positions[0]
    assert sign * moved[axis] > 0.05
    assert np.abs(np.delete(moved, axis)).max() < 1e-9


def test_keys_turn_close_open_and_flick_a_hand() -> None:
    one = driver("hand")
    turned = ticks(one, 60, "u")[-1]
    assert 2.0 * np.arctan2(turned.rotations[0, 3], turned.rotations[0, 0]) > 0.7
    closed = ticks(one, 120, "g")[-1]
    opened = ticks(one, 120, "h")[-1]
    assert closed.angles.sum() > 15.0 and excess(HAND, closed) == 0.0
    assert opened.angles == pytest.approx(HAND.first_sample.angles, abs=1e-9)
    ticks(one, 120)
    before = ticks(one, 1)[-1].positions[0]
    one.press(" ")
    ahead = [np.linalg.norm(sample.positions[0] - before) for sample in ticks(one, 60)]
    assert max(ahead) > 0.04 and ahead[-1] < 1e-12


def test_a_human_reaches_out_and_takes_its_arms_back() -> None:
    one, start = driver("gallery"), places(BODY, BODY.first_sample)
    hands = [BODY.names.index(f"human/{side}_hand") - len(BODY.bodies) for side in ("left", "right")]
    one.press("t")
    out = places(BODY, ticks(one, 120)[-1])
    assert (out[hands, 0] - start[0, 0] > 0.4).all() and (np.abs(out[hands, 2] - start[16, 2]) < 0.1).all()
    one.press("t")
    assert places(BODY, ticks(one, 120)[-1]) == pytest.approx(start, abs=1e-6)
    one.press(" ")
    ahead = [places(BODY, sample)[hands[1], 0] - start[hands[1], 0] for sample in ticks(one, 90)]
    assert max(ahead) > 0.1 and abs(ahead[-1]) < 1e-9


@pytest.mark.parametrize("position", [
    (float("nan"), 0.0, 0.0), (float("inf"), 0.0, 0.0), (1e9, 0.0, 0.0), (0.0, 0.0), "here", None, [[0.0, 0.0, 0.0]],
    (1, True, 2),
])
def test_absurd_goals_are_refused_and_change_nothing(position: object) -> None:
    one, other = driver("gallery"), driver("gallery")
    for k in (one, other):
        k.drag("human/head", (-2.0, 0.2, 1.5))
        k.tick(DT)
    with pytest.raises(InvalidSample):
        one.drag("human/head", position)  # type: ignore[arg-type]
    assert same(one.tick(DT), other.tick(DT))


def test_other_nonsense_is_refused_too() -> None:
    one = driver("gallery")
    with pytest.raises(InvalidSample):
        one.drag("human/head", (0.0, 0.0, 1.0), (1.0, 1.0, 0.0, 0.0))
    for refused, name, thing in ((one.pose, "tail", "link"), (one.release, "tail", "link"), (one.press, "F13", "key")):
        with pytest.raises(UnknownName, match=thing):
            refused(name)
    # no fingers to close, and one arm alone
    assert one.press("g") and driver("hand").press("t")
    for dt in (0.0, -1.0, float("nan"), 1e9, "1"):
        with pytest.raises(InvalidInput):
            one.tick(dt)  # type: ignore[arg-type]
    with pytest.raises(InvalidSample):
        one.set_sample(replace(BODY.first_sample, positions=np.full_like(BODY.first_sample.positions, np.nan)))
    with pytest.raises(InvalidSample):
        one.set_sample(HAND.first_sample)
    with pytest.raises(InvalidSample, match="links of the motion"):
        one.play(Motion(np.zeros(1), np.zeros((1, 2, 3)), np.zeros((1, 2, 4)), np.zeros((1, 0))))
    with pytest.raises(InvalidSample, match="rotations of frame 0"):
        one.play(Motion(np.zeros(1), np.zeros((1, 24, 3)), np.zeros((1, 24, 4)), np.zeros((1, 0))))
    with pytest.raises(InvalidSample):
        one.play(waving(), at=(np.nan, 0.0, 0.0))
    assert same(one.tick(DT), BODY.first_sample)
    with pytest.raises(InvalidInput, match="avatars"):
        Driver(Scene("empty", (fixed("floor", (Piece(Box((1.0, 1.0, 1.0))),), "wood"),)))


def test_other_avatars_stay_unless_they_are_dragged() -> None:
    two = tuple(rigid_avatar(name, BALL, solid(BALL, 1.0)) for name in ("one", "two"))
    start = TrackerSample(0.0, np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]), np.tile((1.0, 0.0, 0.0, 0.0), (2, 1)), np.zeros(0))
    driven = Driver(Scene("two", (), two, start=start))
    moved = ticks(driven, 30, "i")[-1]
    assert moved.positions[0, 0] > 0.05 and moved.positions[1] == pytest.approx((1.0, 0.0, 0.0))
    driven.drag("two", (1.0, 0.5, 0.0))
    assert ticks(driven, 60)[-1].positions[1] == pytest.approx((1.0, 0.5, 0.0))


def test_a_reset_begins_again() -> None:
    one = driver("gallery")
    ticks(one, 30, "i")
    one.reset()
    assert same(one.tick(DT), BODY.first_sample) and one.source == "still"
