"""The engine's calls: settings, order of calls, bad samples, and an engine's life from load to close, one call at a time."""

import gc
import math
from collections.abc import Callable
from dataclasses import replace
from threading import Thread
from typing import Any

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.errors import AvatarsimError, EngineInUse, InvalidInput, InvalidSample, StartOverlaps, UnknownName
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from tests.stability.hostile import hinged_trial
from tests.worlds.little_worlds import at, hand_scene, panel
from tests.worlds.loaded import DT, loaded

BALL = (Piece(Sphere(0.1)),)
SCENE = hand_scene((-0.5, 0.0, 0.0), panel())
DROP = Scene("drop", (simulated("ball", BALL, "wood", solid(BALL, 1.0), (0.0, 0.0, 2.0)),))



def same(a: FrameRecord, b: FrameRecord) -> bool:
    """Return whether two records show the same bits."""
    return a.state_hash() == b.state_hash()


@pytest.mark.parametrize("dt", [0.0, -0.1, math.nan, math.inf, 1.5])
def test_refuses_an_invalid_frame_time(dt: float) -> None:
    with pytest.raises(InvalidInput, match=f"frame time.* {dt}"):
        AvatarsimEngine().load(SCENE, Settings(), dt)
    engine = loaded(SCENE)
    with pytest.raises(InvalidInput, match="frame time"):
        engine.advance(SCENE.first_sample, -abs(dt))
    assert engine.advance(SCENE.first_sample, DT).shown.time == pytest.approx(DT)


@pytest.mark.parametrize("call", [
    lambda engine: engine.advance(SCENE.first_sample, DT), lambda engine: engine.settings_as_run(),
    lambda engine: engine.stage_calls(), lambda engine: engine.reset(), lambda engine: engine.change(SCENE),
    lambda engine: engine.contacts(), lambda engine: engine.snapshot(), lambda engine: engine.restore(b""),
])
def test_nothing_works_before_load_or_after_close(call: Callable[[AvatarsimEngine], object]) -> None:
    engine = loaded(SCENE)
    engine.close()
    engine.close()
    for one in (AvatarsimEngine(), engine):
        with pytest.raises(AvatarsimError, match="no scene is loaded"):
            call(one)


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
    engine = loaded(SCENE)
    with pytest.raises(UnknownName):
        engine.load(DROP, Settings(preset="turbo"), DT)
    assert engine.advance(SCENE.first_sample, DT).shown.positions.shape == (2, 3)


def bad_samples(good: TrackerSample) -> list[Any]:
    """Return one of every kind of bad sample: numbers that are none, wrong shapes, and other types."""
    lost, wrong, places = good.positions.copy(), good.rotations.copy(), good.positions
    lost[0, 1], wrong[0] = math.nan, (2.0, 0.0, 0.0, 0.0)
    crooked = good.angles.copy()
    crooked[-1:] = math.inf
    fields: list[tuple[str, Any]] = [
        *(("positions", one) for one in (
            lost, np.zeros((99, 3)), "abc", None, places * (1.0 + 0.5j), places.astype(str), places != 0.0,
            np.ma.masked_array(places, mask=True),
        )),
        *(("rotations", one) for one in (wrong, np.full_like(wrong, math.nan), np.zeros((len(wrong), 3)), [[1.0]])),
        *(("angles", one) for one in (np.zeros(99), "x", *([crooked] if len(crooked) else []))),
        *(("time", one) for one in (math.nan, "x", None)),
    ]
    return ["lost", *(replace(good, **{name: value}) for name, value in fields)]


@pytest.mark.parametrize("scene", [SCENE, hinged_trial().scene])
def test_a_bad_sample_changes_nothing(scene: Scene) -> None:
    disturbed, quiet = loaded(scene), loaded(scene)
    x, y, z = scene.first_sample.positions[0]
    for k in range(4):
        good = at(scene.first_sample, (x + 0.05 * k, y, z))
        for bad in bad_samples(good):
            with pytest.raises(InvalidSample, match="tracker"):
                disturbed.advance(bad, DT)
        a, b = disturbed.advance(good, DT), quiet.advance(good, DT)
        assert same(a, b) and a.shown.time == b.shown.time


def test_stages_that_a_scene_does_not_call_for_are_not_called() -> None:
    driven = loaded(SCENE)
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
    engine = loaded(SCENE, time_stages=True)
    spent = engine.advance(SCENE.first_sample, DT).stage_ns
    assert {name for name, ns in spent.items() if ns} == {"posture"}, "what is not called for takes no time"
    assert loaded(SCENE).advance(SCENE.first_sample, DT).stage_ns == {}


def test_unsupported_features_are_reported() -> None:
    assert "avatar dynamics" in AvatarsimEngine().unsupported(SCENE)
    assert AvatarsimEngine().unsupported(DROP) == {}
    with pytest.raises(InvalidInput):
        AvatarsimEngine().unsupported(None)  # type: ignore[arg-type]


def test_lists_and_single_precision_are_taken_as_samples() -> None:
    engine, exact = loaded(SCENE), loaded(SCENE)
    good = at(SCENE.first_sample, (-0.25, 0.5, 0.125))
    loose = TrackerSample(0.0, good.positions.tolist(), good.rotations.astype(np.float32), [])  # type: ignore[arg-type]
    assert same(engine.advance(loose, DT), exact.advance(good, DT))


def test_records_are_copies_and_not_windows() -> None:
    engine, other = loaded(SCENE), loaded(SCENE)
    sample = at(SCENE.first_sample, (0.5, 0.2, 0.1))
    before, kept = None, ""
    for _ in range(3):
        record = engine.advance(sample, DT)
        assert same(record, other.advance(sample, DT))
        assert before is None or before.state_hash() == kept
        record.shown.positions[:], record.shown.orientations[:], record.angles[:] = 7.0, 7.0, 7.0
        before, kept = record, record.state_hash()
        # no body is simulated here: all records share the zeros
        assert not record.shown.velocities.flags.writeable and not record.shown.angular_velocities.flags.writeable


def test_without_overlap_removal_the_tracker_is_shown_as_it_is() -> None:
    engine = loaded(replace(SCENE, narrow=("overlap_removal",)))
    inside = at(SCENE.first_sample, (0.5, 0.0, 0.0))
    assert np.array_equal(engine.advance(inside, DT).shown.positions[1], inside.positions[0])
    with pytest.raises(InvalidSample):
        engine.advance(replace(inside, positions=np.full((1, 3), np.nan)), DT)


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_every_preset_runs_and_says_its_settings(preset: str) -> None:
    engine = loaded(SCENE, preset)
    record = engine.advance(at(SCENE.first_sample, (0.5, 0.0, 0.0)), DT)
    assert record.shown.positions[1, 0] < -0.05
    found = engine.settings_as_run()
    assert isinstance(found["method"], tuple) and found["method"][0] == preset
    assert [name for name, pair in found.items() if not (isinstance(pair, tuple) and pair[1])] == [], "each has a meaning"


def test_a_link_without_pieces_is_a_point_that_meets_nobody() -> None:
    """Next to a moving body, where every frame sweeps the boxes of all bodies."""
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
    engine = loaded(Scene("rain", (floor, *balls)), record_inside=True)
    records = [engine.advance(TrackerSample(k * DT, np.zeros((0, 3)), np.zeros((0, 4)), np.zeros(0)), DT) for k in range(1, 6)]
    lost = [record.statuses.get("events not recorded", 0) for record in records]
    landed = max(range(5), key=lambda k: records[k].counts["impacts"])
    assert records[landed].counts["impacts"] >= 200 and lost[landed] == 2 * records[landed].counts["impacts"] - 256


def test_the_spring_does_not_run_away_without_dynamics() -> None:
    """Without dynamics nothing returns the energy that a hand pressing on a loose box took."""
    box, hand = (Piece(Box((0.4, 0.4, 0.4))),), (Piece(Sphere(0.05)),)
    loose = simulated("box", box, "wood", solid(box, 5.0), (0.0, 0.0, 0.2))
    scene = replace(hand_scene((0.0, 0.0, 0.6), loose, shape=hand), narrow=("dynamics",))
    engine = loaded(scene)
    for _ in range(120):
        engine.advance(at(scene.first_sample, (0.0, 0.0, 0.4)), DT)
    for _ in range(20):
        record = engine.advance(at(scene.first_sample, (1.0, 0.0, 1.0)), DT)
    np.testing.assert_allclose(record.shown.positions[1], (1.0, 0.0, 1.0), atol=1e-9)


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_records_that_are_kept_are_few_objects_for_the_collector(preset: str) -> None:
    """A record, its shown state, its counts; all else is arrays, which the collector does not track. With nine objects a frame
    it went through all of numba's again after some hundreds of frames, a pause as long as five of them."""
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    scene = hand_scene((0.0, 0.0, 0.3), floor, simulated("ball", BALL, "wood", solid(BALL, 1.0), (0.5, 0.0, 0.5)))
    engine, sample = loaded(scene, preset), at(scene.first_sample, (0.0, 0.0, 0.03))
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


ELSEWHERE = at(SCENE.first_sample, (-0.4, 0.1, 0.0))


def test_an_engine_is_closed_at_the_end_of_its_block() -> None:
    with pytest.raises(ZeroDivisionError), loaded(SCENE) as engine:
        engine.advance(SCENE.first_sample, DT / 0.0)
    with pytest.raises(AvatarsimError, match="no scene is loaded"):
        engine.advance(SCENE.first_sample, DT)


@pytest.mark.parametrize("scene", [SCENE, DROP])
def test_a_reset_engine_is_one_that_was_loaded_anew(scene: Scene) -> None:
    again, fresh = loaded(scene), loaded(scene)
    for k in range(30):
        again.advance(at(scene.first_sample, (-0.5 + 0.02 * k, 0.0, 0.0)) if scene.avatars else scene.first_sample, DT)
    shown = again.reset()
    assert shown.shown.time == 0.0 and again.snapshot() == fresh.snapshot()
    for _ in range(20):
        assert same(again.advance(scene.first_sample, DT), fresh.advance(scene.first_sample, DT))


def test_a_reset_keeps_its_start_for_the_next_one() -> None:
    again, fresh = loaded(SCENE), loaded(replace(SCENE, start=ELSEWHERE))
    again.advance(SCENE.first_sample, DT)
    for shown in (again.reset(ELSEWHERE), again.reset()):
        assert shown.shown.positions[-1] == pytest.approx((-0.4, 0.1, 0.0)) and shown.shown.time == 0.0
    assert same(again.advance(SCENE.first_sample, DT), fresh.advance(SCENE.first_sample, DT))
    assert again.settings_as_run() == fresh.settings_as_run()


@pytest.mark.parametrize(("start", "error"), [
    (at(SCENE.first_sample, (0.0, 0.0, 0.0)), StartOverlaps), (at(SCENE.first_sample, (math.nan, 0.0, 0.0)), InvalidSample),
    ("home", InvalidSample),
])
def test_a_reset_that_fails_leaves_the_engine_as_it_is(start: Any, error: type[AvatarsimError]) -> None:
    engine = loaded(SCENE, start="exact")
    engine.advance(ELSEWHERE, DT)
    before = engine.snapshot()
    with pytest.raises(error):
        engine.reset(start)
    assert engine.snapshot() == before


@pytest.mark.parametrize(("scene", "settings"), [
    (None, Settings()), ("ball_drop", Settings()), ({}, Settings()), (SCENE.bodies[0], Settings()), (Scene, Settings()),
    (SCENE, None), (SCENE, {}), (SCENE, {"preset": "default"}), (SCENE, "default"),
])
def test_what_is_loaded_is_a_scene_with_settings(scene: Any, settings: Any) -> None:
    engine = loaded(SCENE)
    with pytest.raises(InvalidInput):
        engine.load(scene, settings, DT)
    assert engine.advance(SCENE.first_sample, DT).shown.time == pytest.approx(DT)


class Meanwhile(TrackerSample):
    """A sample that calls the engine, in a thread of its own, while the engine reads it."""

    def __init__(self, call: Callable[[], object], good: TrackerSample) -> None:
        super().__init__(good.time, good.positions, good.rotations, good.angles)
        object.__setattr__(self, "call", call)
        object.__setattr__(self, "errors", [])

    def __getattribute__(self, name: str) -> Any:
        if name == "positions" and hasattr(self, "errors"):
            thread = Thread(target=self.attempt)
            thread.start()
            thread.join()
        return super().__getattribute__(name)

    def attempt(self) -> None:
        """The call, its error kept."""
        try:
            self.call()
        except AvatarsimError as error:
            self.errors.append(error)


CALLS: dict[str, Callable[[AvatarsimEngine], object]] = {
    "advance": lambda engine: engine.advance(SCENE.first_sample, DT), "snapshot": lambda engine: engine.snapshot(),
    "load": lambda engine: engine.load(DROP, Settings(), DT), "reset": lambda engine: engine.reset(),
    "restore": lambda engine: engine.restore(b""), "close": lambda engine: engine.close(),
}


@pytest.mark.parametrize("call", list(CALLS))
def test_a_second_thread_is_refused_while_a_frame_is_under_way(call: str) -> None:
    engine, alone = loaded(SCENE), loaded(SCENE)
    sample = Meanwhile(lambda: CALLS[call](engine), ELSEWHERE)
    assert same(engine.advance(sample, DT), alone.advance(ELSEWHERE, DT))
    assert sample.errors and all(isinstance(error, EngineInUse) for error in sample.errors)
    # and is welcome afterwards
    assert same(engine.advance(SCENE.first_sample, DT), alone.advance(SCENE.first_sample, DT))


def test_one_thread_after_the_other_is_welcome() -> None:
    engine, records = loaded(SCENE), []
    for _ in range(3):
        thread = Thread(target=lambda: records.append(engine.advance(SCENE.first_sample, DT)))
        thread.start()
        thread.join()
    assert len(records) == 3 and records[-1].shown.time == pytest.approx(3 * DT)


@pytest.mark.parametrize(("settings", "unknown", "known"), [
    (Settings(preset="turbo"), "turbo", "default"), (Settings(options={"stand_of": 1e-4}), "stand_of", "stand_off"),
])
def test_unknown_names_are_refused_and_the_known_ones_listed(settings: Settings, unknown: str, known: str) -> None:
    with pytest.raises(UnknownName, match=f"{unknown}'.*{known}"):
        AvatarsimEngine().load(SCENE, settings, DT)


@pytest.mark.parametrize("value", [-1.0, 0.0, math.nan, math.inf, "fast", None, True])
@pytest.mark.parametrize("name", ["stand_off", "steps", "spring"])
def test_options_are_finite_numbers(name: str, value: Any) -> None:
    with pytest.raises(InvalidInput, match=f"option {name} "):
        loaded(SCENE, options={name: value})


@pytest.mark.parametrize(("name", "value"), [("tolerance", 1e-3), ("walk_back", 0.0)])
def test_options_that_do_not_go_together_are_refused(name: str, value: float) -> None:
    """A tolerance above the stand-off, and a walk back without an end."""
    with pytest.raises(InvalidInput, match=f"option {name} is {value:g}"):
        loaded(SCENE, "paper", options={name: value})


def test_options_are_in_force_and_reported() -> None:
    for stand_off in (2e-4, 1e-3):
        engine = loaded(SCENE, options={"stand_off": stand_off, "steps": 3, "spring": 500})
        for _ in range(20):
            record = engine.advance(at(SCENE.first_sample, (0.5, 0.0, 0.0)), DT)
        assert -record.shown.positions[1, 0] - 0.051 == pytest.approx(stand_off, rel=0.3)
    told = engine.settings_as_run()
    values = {name: pair[0] for name, pair in told.items() if isinstance(pair, tuple)}
    assert values["stand_off"] == 1e-3 and values["steps"] == 3 and values["spring"] == 500.0 and values["damping"] == 40.0
    assert values["method"] == "default"



@pytest.mark.parametrize("stand_off", [2e-5, 2e-4, 1e-3, 5e-3])
def test_a_hand_pushes_what_is_loose_whatever_air_it_keeps(stand_off: float) -> None:
    """The upper loop has to know how near a driven body comes, or a ball that floats stops the user like a wall."""
    feather = (Piece(Sphere(0.05)),)
    ball = simulated("ball", feather, "wood", solid(feather, 0.2), (0.2, 0.0, 0.0))
    scene = replace(hand_scene((0.0, 0.0, 0.0), ball), gravity=(0.0, 0.0, 0.0))
    for speed in (0.003, 0.005, 0.0071):
        engine = loaded(scene, options={"stand_off": stand_off})
        for k in range(int(0.5 / speed)):
            record = engine.advance(at(scene.first_sample, (speed * k, 0.0, 0.0)), DT)
        assert record.shown.positions[0, 0] > 0.5 + 0.1 - 2.0 * speed


@pytest.mark.parametrize(("field", "value"), [
    ("preset", None), ("preset", 3), ("options", None), ("options", [1]), ("options", {1: 2}), ("options", "steps"),
    ("seed", "a"), ("seed", 1.5), ("seed", True), ("seed", None), ("record_inside", 1), ("time_stages", "yes"),
    ("start", "somewhere"),
])
def test_settings_of_another_type_are_refused(field: str, value: Any) -> None:
    with pytest.raises(InvalidInput, match=field):
        Settings(**{field: value})


def test_a_seed_and_flags_of_numpy_are_the_numbers_that_they_are() -> None:
    plain, narrow = loaded(SCENE, "paper", seed=5), AvatarsimEngine()
    settings = Settings("paper", seed=np.int8(5), record_inside=np.bool_(False))  # type: ignore[arg-type]
    narrow.load(SCENE, settings, DT)
    assert type(settings.seed) is int and plain.snapshot() == narrow.snapshot()
