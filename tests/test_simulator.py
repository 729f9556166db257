"""The engine's doors: settings, order of calls, bad samples, and stages that are not called for."""

import gc
import math
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.engine import Engine, FrameRecord, Settings
from avatarsim.errors import AvatarsimError, InvalidInput, InvalidSample, UnknownName
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from tests.stability.hostile import DT, hinged_trial
from tests.worlds.little_worlds import at, hand_scene, panel

BALL = (Piece(Sphere(0.1)),)
SCENE = hand_scene((-0.5, 0.0, 0.0), panel())
DROP = Scene("drop", (simulated("ball", BALL, "wood", solid(BALL, 1.0), (0.0, 0.0, 2.0)),))


def loaded(scene: Scene = SCENE, **options: object) -> AvatarsimEngine:
    """An engine that has loaded a scene."""
    engine = AvatarsimEngine()
    engine.load(scene, Settings(options=options), DT)
    return engine


def same(a: FrameRecord, b: FrameRecord) -> bool:
    """Two records show the same bits."""
    return a.state_hash() == b.state_hash()


def test_it_is_an_engine() -> None:
    assert isinstance(AvatarsimEngine(), Engine) and AvatarsimEngine().presets[0] == "default"


@pytest.mark.parametrize("dt", [0.0, -0.1, math.nan, math.inf, 1.5])
def test_frame_times_at_load(dt: float) -> None:
    with pytest.raises(InvalidInput, match=r"frame time \[s\] is .*; valid: a number above 0 and at most 1"):
        AvatarsimEngine().load(SCENE, Settings(), dt)


@pytest.mark.parametrize("dt", [0.0, -0.1, math.nan, math.inf])
def test_frame_times_at_advance(dt: float) -> None:
    """A negative or nan frame time must not turn time back, or make it a nan for good."""
    engine = loaded()
    with pytest.raises(InvalidInput, match="frame time"):
        engine.advance(SCENE.first_sample, dt)
    assert engine.advance(SCENE.first_sample, DT).shown.time == pytest.approx(DT)


@pytest.mark.parametrize("call", ["advance", "settings_as_run", "stage_calls"])
def test_nothing_works_before_load_or_after_close(call: str) -> None:
    arguments = (SCENE.first_sample, DT) if call == "advance" else ()
    with pytest.raises(AvatarsimError, match="no scene is loaded"):
        getattr(AvatarsimEngine(), call)(*arguments)
    engine = loaded()
    engine.close()
    with pytest.raises(AvatarsimError, match="no scene is loaded"):
        getattr(engine, call)(*arguments)
    engine.close()


def test_loading_again_starts_again() -> None:
    engine = AvatarsimEngine()
    first = engine.load(SCENE, Settings(), DT)
    for _ in range(3):
        moved = engine.advance(at(SCENE.first_sample, (-0.2, 0.1, 0.0)), DT)
    again = engine.load(SCENE, Settings(), DT)
    assert same(first, again) and not same(first, moved) and again.shown.time == 0.0
    assert sum(engine.stage_calls().values()) == 0
    other = engine.load(DROP, Settings(), DT)
    assert other.shown.positions.shape == (1, 3) and other.angles.shape == (0,)


def test_a_load_that_fails_leaves_the_loaded_scene_running() -> None:
    engine = loaded()
    with pytest.raises(UnknownName):
        engine.load(DROP, Settings(preset="turbo"), DT)
    assert engine.advance(SCENE.first_sample, DT).shown.positions.shape == (2, 3)


def test_records_are_snapshots_and_not_windows() -> None:
    engine = loaded()
    first = engine.advance(at(SCENE.first_sample, (-0.3, 0.0, 0.0)), DT)
    kept = first.state_hash()
    engine.advance(at(SCENE.first_sample, (-0.2, 0.3, 0.0)), DT)
    assert first.state_hash() == kept
    first.shown.positions[:] = 9.0
    first.angles[:] = 9.0
    assert (np.abs(engine.advance(SCENE.first_sample, DT).shown.positions) < 5.0).all()


def bad_samples(good: TrackerSample) -> list[TrackerSample]:
    """One of every kind of bad sample."""
    lost, wrong = good.positions.copy(), good.rotations.copy()
    lost[0, 1], wrong[0] = math.nan, (2.0, 0.0, 0.0, 0.0)
    crooked = good.angles.copy()
    crooked[-1:] = math.inf
    samples = [
        replace(good, positions=lost),
        replace(good, rotations=wrong),
        replace(good, rotations=np.full_like(wrong, math.nan)),
        replace(good, positions=np.zeros((99, 3))),
        replace(good, rotations=np.zeros((len(wrong), 3))),
        replace(good, angles=np.zeros(99)),
    ]
    return samples + ([replace(good, angles=crooked)] if len(crooked) else [])


@pytest.mark.parametrize("scene", [SCENE, hinged_trial().scene])
def test_a_bad_sample_changes_nothing_and_the_next_good_one_works(scene: Scene) -> None:
    disturbed, quiet = loaded(scene), loaded(scene)
    x, y, z = scene.first_sample.positions[0]
    for k in range(8):
        good = at(scene.first_sample, (x + 0.05 * k, y, z))
        for bad in bad_samples(good):
            with pytest.raises(InvalidSample):
                disturbed.advance(bad, DT)
        a, b = disturbed.advance(good, DT), quiet.advance(good, DT)
        assert same(a, b) and a.shown.time == b.shown.time


def test_stages_that_a_scene_does_not_call_for_are_not_called() -> None:
    driven = loaded()
    for _ in range(3):
        driven.advance(SCENE.first_sample, DT)
    calls = driven.stage_calls()
    assert calls["posture"] == 3 and all(count == 0 for name, count in calls.items() if name != "posture")
    falling = loaded(DROP)
    for _ in range(3):
        falling.advance(rest(()), DT)
    calls = falling.stage_calls()
    assert calls["posture"] == 0 and calls["coupling"] == 0


def test_stages_are_timed_only_on_request() -> None:
    engine = AvatarsimEngine()
    engine.load(SCENE, Settings(time_stages=True), DT)
    spent = engine.advance(SCENE.first_sample, DT).stage_ns
    assert spent.pop("posture") > 0 and set(spent.values()) == {0}, "what is not called for takes no time"
    assert loaded().advance(SCENE.first_sample, DT).stage_ns == {}


def test_what_it_cannot_say_is_said() -> None:
    assert "avatar dynamics" in AvatarsimEngine().cannot_say(SCENE)
    assert AvatarsimEngine().cannot_say(DROP) == {}
    with pytest.raises(InvalidInput, match="scene to describe is None; valid: a Scene"):
        AvatarsimEngine().cannot_say(None)


def test_lists_and_single_precision_are_taken_as_samples() -> None:
    engine, exact = loaded(), loaded()
    good = at(SCENE.first_sample, (-0.25, 0.5, 0.125))
    loose = TrackerSample(0.0, good.positions.tolist(), good.rotations.astype(np.float32), [])
    assert same(engine.advance(loose, DT), exact.advance(good, DT))


def test_bodies_that_stand_still_are_shown_where_they_were_put() -> None:
    engine = loaded()
    for _ in range(5):
        record = engine.advance(at(SCENE.first_sample, (0.5, 0.2, 0.1)), DT)
    assert record.shown.positions[0].tolist() == [0.0, 0.0, 0.0] and record.shown.orientations[0].tolist() == [1.0, 0.0, 0.0, 0.0]
    assert not record.shown.velocities[0].any()


def test_who_writes_into_a_record_changes_no_other() -> None:
    engine, other = loaded(), loaded()
    sample = at(SCENE.first_sample, (0.5, 0.2, 0.1))
    for _ in range(3):
        record = engine.advance(sample, DT)
        assert same(record, other.advance(sample, DT))
        record.shown.positions[:], record.shown.orientations[:] = 7.0, 7.0
        # no body is simulated here: all records share the zeros
        assert not record.shown.velocities.flags.writeable and not record.shown.angular_velocities.flags.writeable


def test_without_overlap_removal_the_tracker_is_shown_as_it_is() -> None:
    engine = AvatarsimEngine()
    engine.load(replace(SCENE, narrow=("overlap_removal",)), Settings(), DT)
    inside = at(SCENE.first_sample, (0.5, 0.0, 0.0))
    assert np.array_equal(engine.advance(inside, DT).shown.positions[1], inside.positions[0])
    with pytest.raises(InvalidSample):
        engine.advance(replace(inside, positions=np.full((1, 3), np.nan)), DT)


def test_a_sample_at_no_time_is_refused() -> None:
    with pytest.raises(InvalidSample, match="tracker time"):
        loaded().advance(replace(SCENE.first_sample, time=np.nan), DT)


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_every_preset_runs_and_says_its_settings(preset: str) -> None:
    engine = AvatarsimEngine()
    engine.load(SCENE, Settings(preset=preset), DT)
    record = engine.advance(at(SCENE.first_sample, (0.5, 0.0, 0.0)), DT)
    assert record.shown.positions[1, 0] < -0.05
    method = engine.settings_as_run()["method"]
    assert isinstance(method, tuple) and method[0] == preset and " " in method[1]


@pytest.mark.parametrize(
    ("what", "value"),
    [("positions", "abc"), ("positions", None), ("rotations", [[1.0]]), ("angles", "x"), ("time", "x"), ("time", None)],
)
def test_a_sample_of_words_is_refused_and_the_next_good_one_works(what: str, value: object) -> None:
    engine = loaded()
    with pytest.raises(InvalidSample, match="tracker"):
        engine.advance(replace(SCENE.first_sample, **{what: value}), DT)
    with pytest.raises(InvalidSample, match="tracker sample is None"):
        engine.advance(None, DT)
    assert engine.advance(SCENE.first_sample, DT).shown.time == pytest.approx(DT)


def test_a_link_without_pieces_is_a_point_that_meets_nobody() -> None:
    """Beside something that moves, where every frame sweeps the boxes of all bodies."""
    tip = Link("tip", "palm", Hinges((Hinge((0.0, 1.0, 0.0), -1.0, 1.0),)), (), solid(BALL, 1.0), anchor=(0.2, 0.0, 0.0))
    palm = Link("palm", None, Free(), BALL, solid(BALL, 1.0))
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    ball = simulated("ball", BALL, "wood", solid(BALL, 1.0), (1.0, 0.0, 0.15))
    avatar = Avatar("hand", (palm, tip), ("tip",), ())
    start = replace(rest((avatar,)), positions=np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]))
    engine = loaded(Scene("bare", (floor, ball), (avatar,), start=start))
    for k in range(30):
        record = engine.advance(replace(start, time=(k + 1) * DT), DT)
        assert not any("not finite" in status for status in record.statuses)
    assert 0.1 <= record.shown.positions[1, 2] < 0.15


def test_events_that_found_no_room_are_counted() -> None:
    """200 balls land at once; a recording keeps 256 events of a frame, two per impact."""
    piece = (Piece(Sphere(0.05)),)
    balls = [simulated(f"b{k}", piece, "wood", solid(piece, 0.1), (0.2 * (k % 20), 0.2 * (k // 20), 0.06)) for k in range(200)]
    floor = fixed("floor", (Piece(Box((20.0, 20.0, 1.0))),), "wood", (0.0, 0.0, -0.5))
    engine = AvatarsimEngine()
    engine.load(Scene("rain", (floor, *balls)), Settings(record_inside=True), DT)
    records = [engine.advance(TrackerSample(k * DT, np.zeros((0, 3)), np.zeros((0, 4)), np.zeros(0)), DT) for k in range(1, 6)]
    lost = [record.statuses.get("events not recorded", 0) for record in records]
    landed = max(range(5), key=lambda k: records[k].counts["impacts"])
    assert records[landed].counts["impacts"] >= 200 and lost[landed] == 2 * records[landed].counts["impacts"] - 256


def test_the_spring_does_not_run_away_where_nothing_moves_by_itself() -> None:
    """Without dynamics nothing gives back what a hand that presses on a loose box took."""
    box, hand = (Piece(Box((0.4, 0.4, 0.4))),), (Piece(Sphere(0.05)),)
    loose = simulated("box", box, "wood", solid(box, 5.0), (0.0, 0.0, 0.2))
    scene = replace(hand_scene((0.0, 0.0, 0.6), loose, shape=hand), narrow=("dynamics",))
    engine = loaded(scene)
    for _ in range(120):
        engine.advance(at(scene.first_sample, (0.0, 0.0, 0.4)), DT)
    for _ in range(8):
        record = engine.advance(at(scene.first_sample, (1.0, 0.0, 1.0)), DT)
    np.testing.assert_allclose(record.shown.positions[1], (1.0, 0.0, 1.0), atol=1e-9)


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_records_that_are_kept_are_few_objects_for_the_collector(preset: str) -> None:
    """A record, what it shows, what it counted; all else is arrays, which the collector does not track. With nine objects a frame
    it went through all of numba's again after some hundreds of frames, a pause as long as five of them."""
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    scene = hand_scene((0.0, 0.0, 0.3), floor, simulated("ball", BALL, "wood", solid(BALL, 1.0), (0.5, 0.0, 0.5)))
    engine, sample, kept = AvatarsimEngine(), at(scene.first_sample, (0.0, 0.0, 0.03)), []
    engine.load(scene, Settings(preset), DT)
    kept = [engine.advance(sample, DT) for _ in range(50)]
    gc.collect()
    gc.disable()
    try:
        before = len(gc.get_objects())
        for _ in range(200):
            kept.append(engine.advance(sample, DT))
        made = len(gc.get_objects()) - before
    finally:
        gc.enable()
    assert made <= 3 * 200 + 10
    assert kept[-2].statuses is kept[-1].statuses is kept[-1].stage_ns and not kept[-1].statuses
    assert any(record.counts["segments"] for record in kept) and any(record.counts["pairs"] for record in kept)
