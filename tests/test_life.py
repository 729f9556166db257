"""The life of an engine: it closes itself, begins again where it is told to, and answers one call at a time."""

import math
from collections.abc import Callable
from dataclasses import replace
from threading import Thread

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError, EngineInUse, InvalidInput, InvalidSample, StartOverlaps
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from tests.stability.hostile import DT
from tests.test_simulator import DROP, SCENE, loaded, same
from tests.worlds.little_worlds import at

ELSEWHERE = at(SCENE.first_sample, (-0.4, 0.1, 0.0))


def test_an_engine_is_closed_at_the_end_of_its_block() -> None:
    with AvatarsimEngine() as engine:
        engine.load(SCENE, Settings(), DT)
        assert engine.advance(SCENE.first_sample, DT).shown.time == pytest.approx(DT)
    with pytest.raises(AvatarsimError, match="no scene is loaded"):
        engine.advance(SCENE.first_sample, DT)
    with pytest.raises(ZeroDivisionError), AvatarsimEngine() as engine:
        engine.load(SCENE, Settings(), 1 / 0)


@pytest.mark.parametrize("scene", [SCENE, DROP])
def test_a_reset_engine_is_one_that_was_loaded_anew(scene: Scene) -> None:
    again, fresh = loaded(scene), loaded(scene)
    for k in range(30):
        again.advance(at(scene.first_sample, (-0.5 + 0.02 * k, 0.0, 0.0)) if scene.avatars else scene.first_sample, DT)
    shown = again.reset()
    assert shown.shown.time == 0.0 and again.snapshot() == fresh.snapshot()
    for _ in range(20):
        assert same(again.advance(scene.first_sample, DT), fresh.advance(scene.first_sample, DT))


def test_a_reset_engine_begins_where_it_is_told_to_and_there_the_next_time() -> None:
    again, fresh = loaded(), loaded(replace(SCENE, start=ELSEWHERE))
    again.advance(SCENE.first_sample, DT)
    for shown in (again.reset(ELSEWHERE), again.reset()):
        assert shown.shown.positions[-1] == pytest.approx((-0.4, 0.1, 0.0)) and shown.shown.time == 0.0
    assert same(again.advance(SCENE.first_sample, DT), fresh.advance(SCENE.first_sample, DT))
    assert again.settings_as_run() == fresh.settings_as_run()


@pytest.mark.parametrize(("start", "error"), [
    (at(SCENE.first_sample, (0.0, 0.0, 0.0)), StartOverlaps), (at(SCENE.first_sample, (math.nan, 0.0, 0.0)), InvalidSample),
    ("home", InvalidSample),
])
def test_a_reset_that_fails_leaves_the_engine_as_it_is(start: object, error: type[AvatarsimError]) -> None:
    engine = loaded()
    engine.advance(ELSEWHERE, DT)
    before = engine.snapshot()
    with pytest.raises(error):
        engine.reset(start)
    assert engine.snapshot() == before


def test_there_is_nothing_to_reset_before_load() -> None:
    with pytest.raises(AvatarsimError, match="no scene is loaded"):
        AvatarsimEngine().reset()


@pytest.mark.parametrize("scene", [None, "ball_drop", {}, SCENE.bodies[0], Scene])
def test_what_is_loaded_is_a_scene(scene: object) -> None:
    engine = loaded()
    with pytest.raises(InvalidInput, match="scene to load is .*; valid: a Scene"):
        engine.load(scene, Settings(), DT)
    assert engine.advance(SCENE.first_sample, DT).shown.time == pytest.approx(DT)


class Meanwhile(TrackerSample):
    """A sample that calls the engine, in a thread of its own, while the engine reads it."""

    def __init__(self, call: Callable[[], object], good: TrackerSample) -> None:
        super().__init__(good.time, good.positions, good.rotations, good.angles)
        object.__setattr__(self, "call", call)
        object.__setattr__(self, "errors", [])

    def __getattribute__(self, name: str) -> object:
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
    engine, alone = loaded(), loaded()
    sample = Meanwhile(lambda: CALLS[call](engine), ELSEWHERE)
    assert same(engine.advance(sample, DT), alone.advance(ELSEWHERE, DT))
    assert sample.errors and all(isinstance(error, EngineInUse) for error in sample.errors)
    assert "an engine of its own" in str(sample.errors[0])
    # and is welcome afterwards
    assert same(engine.advance(SCENE.first_sample, DT), alone.advance(SCENE.first_sample, DT))


def test_one_thread_after_the_other_is_welcome() -> None:
    engine, records = loaded(), []
    for _ in range(3):
        thread = Thread(target=lambda: records.append(engine.advance(SCENE.first_sample, DT)))
        thread.start()
        thread.join()
    assert len(records) == 3 and records[-1].shown.time == pytest.approx(3 * DT)


def test_an_error_in_a_frame_leaves_the_engine_free_for_the_next() -> None:
    engine = loaded()
    for bad in (None, replace(ELSEWHERE, angles=np.zeros(9)), replace(ELSEWHERE, positions=ELSEWHERE.positions * (1.0 + 0j))):
        with pytest.raises(InvalidSample):
            engine.advance(bad, DT)
    assert engine.advance(ELSEWHERE, DT).shown.time == pytest.approx(DT)


@pytest.mark.parametrize("change", ["complex", "text", "masked", "truth"])
def test_samples_are_of_real_numbers(change: str) -> None:
    engine, places = loaded(), ELSEWHERE.positions
    wrong = {
        "complex": places * (1.0 + 0.5j), "text": places.astype(str), "masked": np.ma.masked_array(places, mask=True),
        "truth": places != 0.0,
    }
    with pytest.raises(InvalidSample, match="tracker positions is .*real numbers"):
        engine.advance(replace(ELSEWHERE, positions=wrong[change]), DT)
