"""Many worlds in one call: the same bits as one by one, with any threads, and one that fails does not keep the others."""

from collections.abc import Callable
from dataclasses import replace
from itertools import cycle, islice
from typing import Any

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.errors import AvatarsimError, EngineInUse, InvalidInput, InvalidSample, WorldsFailed
from avatarsim.many_worlds import PORTION, advance_many
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from tests.stability.hostile import hinged_trial
from tests.worlds.little_worlds import at, hand, hand_scene, panel
from tests.worlds.loaded import DT, loaded

BALL = (Piece(Sphere(0.1)),)
FLOOR = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "wood", (0.0, 0.0, -0.05))
LOOSE = simulated("ball", BALL, "wood", solid(BALL, 0.3), (0.3, 0.0, 0.15))
SCENES = {
    "hand": hand_scene((-0.5, 0.0, 0.3), panel()),
    "hand and ball": hand_scene((-0.5, 0.0, 0.3), FLOOR, LOOSE),
    "humanoid": hinged_trial().scene,
    "no avatar": Scene("drop", (FLOOR, LOOSE)),
    "nothing moves": Scene("still", (FLOOR,)),
    "no overlap removal": replace(hand_scene((-0.5, 0.0, 0.3), panel()), narrow=("overlap_removal",)),
    "two hands": Scene("two", (FLOOR,), (hand(name="left"), hand(name="right")), start=TrackerSample(
        0.0, np.array([[0.0, 0.3, 0.5], [0.0, -0.3, 0.5]]), np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), np.zeros(0),
    )),
}
WAYS = {
    "default": Settings(), "paper": Settings("paper"), "recorded": Settings(record_inside=True),
    "timed": Settings(time_stages=True), "once around": Settings(options={"around": 2, "work": 300}, seed=3),
}


def sample(scene: Scene, frame: int, seed: int) -> TrackerSample:
    """Return a place in the room, at a walking pace: into walls, floors and loose bodies too."""
    rng, first = np.random.default_rng(seed), scene.first_sample
    if not scene.avatars:
        return first
    way = np.array([0.02, 0.0, -0.01]) * frame + 0.01 * rng.normal(size=3)
    bent = first.angles + 0.02 * frame * np.sign(rng.normal(size=first.angles.shape))
    return TrackerSample(frame * DT, first.positions + way, first.rotations, bent)


def engines(count: int) -> tuple[list[Scene], list[AvatarsimEngine], list[AvatarsimEngine]]:
    """So many worlds of all kinds, twice."""
    kinds = list(islice(cycle([(scene, way) for scene in SCENES.values() for way in WAYS.values()]), count))
    both: tuple[list[AvatarsimEngine], list[AvatarsimEngine]] = ([], [])
    for scene, way in kinds:
        for made in both:
            made.append(AvatarsimEngine())
            made[-1].load(scene, way, DT)
    return [scene for scene, _ in kinds], *both


def same(one: FrameRecord, other: FrameRecord) -> bool:
    """Return whether two records are equal, times of stages aside."""
    inside = [(step.time, step.event, step.positions.tobytes(), step.velocities.tobytes()) for step in one.inside]
    return (
        one.state_hash() == other.state_hash() and one.shown.time == other.shown.time
        and dict(one.counts) == dict(other.counts) and dict(one.statuses) == dict(other.statuses)
        and one.stage_ns.keys() == other.stage_ns.keys()
        and inside == [(step.time, step.event, step.positions.tobytes(), step.velocities.tobytes()) for step in other.inside]
    )


@pytest.mark.parametrize("threads", [1, 2, 3, None])
def test_many_worlds_are_to_the_bit_what_each_is_alone(threads: int | None) -> None:
    scenes, together, alone = engines(len(SCENES) * len(WAYS))
    for frame in range(1, 16):
        asked = [sample(scene, frame, 100 * frame + k) for k, scene in enumerate(scenes)]
        records = advance_many(together, asked, DT, threads)
        for k, (engine, record) in enumerate(zip(alone, records, strict=True)):
            assert same(record, engine.advance(asked[k], DT)), (frame, k, scenes[k].name)
    for k, (one, other) in enumerate(zip(together, alone, strict=True)):
        assert one.snapshot() == other.snapshot() and one.stage_calls() == other.stage_calls(), k
        # and alone they go on from there
        assert same(one.advance(asked[k], DT), other.advance(asked[k], DT))


@pytest.mark.parametrize("name", ["hand", "hand and ball", "humanoid", "no avatar"])
def test_worlds_go_on_together_from_wherever_they_were_put(name: str) -> None:
    scene = SCENES[name]
    together, alone = (loaded(scene) for _ in range(2))
    turns: list[Callable[[AvatarsimEngine], object]] = [
        lambda engine: engine.restore(kept), lambda engine: engine.change(scene), lambda engine: engine.reset(),
    ]
    frame = 0
    for turn in turns:
        kept = together.snapshot()
        for _ in range(5):
            frame += 1
            (record,) = advance_many([together], [sample(scene, frame, 7)], DT)
            assert same(record, alone.advance(sample(scene, frame, 7), DT))
        turn(together), turn(alone)


def test_bodies_put_elsewhere_are_shown_there() -> None:
    together, alone = hands(2)
    for height in (0.7, 0.9):
        for engine in (together, alone):
            engine.place({"panel": ((0.5, 0.0, height), (1.0, 0.0, 0.0, 0.0))})
        (record,) = advance_many([together], [HOME], DT)
        assert same(record, alone.advance(HOME, DT)) and record.shown.positions[0, 2] == height


def hands(count: int) -> list[AvatarsimEngine]:
    """So many worlds with one hand, loaded."""
    return [loaded(SCENES["hand"]) for _ in range(count)]


HOME = SCENES["hand"].first_sample
BAD = at(HOME, (np.nan, 0.0, 0.0))


def test_more_worlds_than_a_portion_holds() -> None:
    many = hands(2 * PORTION + 3)
    asked = [at(HOME, (-0.5, 0.001 * k, 0.3)) for k in range(len(many))]
    for threads in (1, 2):
        records = advance_many(many, asked, DT, threads)
        assert [record.shown.positions[-1, 1] for record in records] == pytest.approx([0.001 * k for k in range(len(many))])
    assert advance_many([], [], DT) == ()


@pytest.mark.parametrize("threads", [1, 2])
def test_a_world_that_fails_does_not_keep_the_others(threads: int) -> None:
    many = [*hands(3), AvatarsimEngine(), *hands(2)]
    asked: list[TrackerSample] = [HOME, BAD, HOME, HOME, rest(()), HOME]
    with many[5]._alone(), pytest.raises(WorldsFailed) as found:
        advance_many(many, asked, DT, threads)
    errors: dict[int, Exception] = dict(found.value.errors)
    records: Any = found.value.records
    assert list(errors) == [1, 3, 4, 5] and [record is None for record in records] == [k in errors for k in range(6)]
    assert isinstance(errors[1], InvalidSample) and isinstance(errors[4], InvalidSample) and isinstance(errors[5], EngineInUse)
    assert records[2].shown.time == pytest.approx(DT)
    # those that failed are where they were, and none is in use
    for k in (1, 4, 5):
        assert many[k].advance(HOME, DT).shown.time == pytest.approx(DT)
    assert advance_many([many[0], many[2]], [HOME, HOME], DT, threads)[0].shown.time == pytest.approx(2.0 * DT)


WRONG: dict[str, Callable[[list[AvatarsimEngine]], tuple[Any, ...]]] = {
    "engines are none": lambda many: (None, [HOME] * 2, DT, None),
    "engines as keys": lambda many: (dict.fromkeys(many), [HOME] * 2, DT, None),
    "an engine is none": lambda many: ([*many, None], [HOME] * 3, DT, None),
    "an engine is a word": lambda many: ([*many, "engine"], [HOME] * 3, DT, None),
    "an engine twice": lambda many: ([*many, many[0]], [HOME] * 3, DT, None),
    "samples are none": lambda many: (many, None, DT, None),
    "samples by name": lambda many: (many, {0: HOME, 1: HOME}, DT, None),
    "a stream": lambda many: (many, iter([HOME, HOME]), DT, None),
    "one number": lambda many: (many, np.array(1.0), DT, None),
    "too few samples": lambda many: (many, [HOME], DT, None),
    "time is none": lambda many: (many, [HOME] * 2, None, None),
    "time is no number": lambda many: (many, [HOME] * 2, float("nan"), None),
    "no time": lambda many: (many, [HOME] * 2, 0.0, None),
    "no threads": lambda many: (many, [HOME] * 2, DT, 0),
    "half a thread": lambda many: (many, [HOME] * 2, DT, 1.5),
    "threads in words": lambda many: (many, [HOME] * 2, DT, "two"),
    "endless threads": lambda many: (many, [HOME] * 2, DT, float("inf")),
}


@pytest.mark.parametrize("case", list(WRONG))
def test_refused_arguments_leave_every_world_as_it_was(case: str) -> None:
    many = hands(2)
    before = [engine.snapshot() for engine in many]
    with pytest.raises(InvalidInput):
        advance_many(*WRONG[case](many))
    assert [engine.snapshot() for engine in many] == before


def test_a_sample_that_is_none_fails_its_world_alone() -> None:
    with pytest.raises(WorldsFailed) as found:
        advance_many(hands(2), [HOME, "sample"], DT)  # type: ignore[list-item]
    assert [type(error) for error in found.value.errors.values()] == [InvalidSample]
    assert issubclass(WorldsFailed, AvatarsimError)
