"""Work of `load` ahead of the first frame: it brings every kernel into memory, and leaves no trace in shown states."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from avatarsim.compile_ahead import part_scene
from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError
from avatarsim.frame import Frames
from avatarsim.model.world import build
from avatarsim.rehearsal import Undo
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import Chosen
from avatarsim.simulator import AvatarsimEngine
from tests.stability.hostile import DT
from tests.worlds.little_worlds import at
from tests.worlds.loaded import loaded

TOGETHER = part_scene("together")[0]
PRESETS = ("default", "paper")
SCENES = {
    "an avatar and a ball": TOGETHER,
    "an avatar that removes no overlap": replace(TOGETHER, narrow=("overlap_removal",)),
    "an avatar alone": part_scene("posture")[0],
    "a ball alone": part_scene("motion")[0],
}
CASES = [(name, preset) for name in SCENES for preset in PRESETS]


def lively(scene: Scene, frames: int) -> Iterator[TrackerSample]:
    """Move the first avatar down onto the floor; any ball falls by itself."""
    first = scene.first_sample
    for k in range(frames):
        yield at(first, (0.5, 0.5, 0.5 - 0.02 * k)) if scene.avatars else first


def leaves(value: object, seen: dict[int, bytes]) -> dict[int, bytes]:
    """Return the bits of every array in nested tuples, by identity."""
    if isinstance(value, np.ndarray):
        seen[id(value)] = value.tobytes()
    elif isinstance(value, tuple):
        for part in value:
            leaves(part, seen)
    return seen


def state(parts: tuple[Any, ...]) -> list[Any]:
    """Return for every part which object each attribute is, the bits of its arrays, its plain numbers."""
    found = []
    for part in parts:
        names = getattr(type(part), "__slots__", None) or vars(part)
        held = {name: getattr(part, name) for name in names if hasattr(part, name)}
        numbers = {name: value for name, value in held.items() if isinstance(value, int | float | str)}
        objects = {name: id(value) for name, value in held.items() if name not in numbers}
        found.append((objects, leaves(tuple(held.values()), {}), numbers))
    return found


@pytest.mark.parametrize(("name", "preset"), CASES)
def test_a_frame_is_undone_by_what_it_changed_first(name: str, preset: str) -> None:
    """At load, and amid contacts: the same frame changes the same words, whatever ran before."""
    frames = Frames(build(SCENES[name]), preset, Chosen(), 3, record=True, time_stages=True)
    for sample in lively(SCENES[name], 22):
        before = state(frames.parts())
        undo = Undo(frames.parts())
        frames.frame(sample, DT)
        undo.keep_what_changed()
        undo()
        assert state(frames.parts()) == before
        for _ in range(3):
            frames.frame(sample, DT)
            assert state(frames.parts()) != before
            undo()
            assert state(frames.parts()) == before
        frames.frame(sample, DT)


def test_only_what_changed_is_written_again() -> None:
    """Writing all of it would leave the caches full of memory that no frame reads."""
    world = build(TOGETHER)
    undo = Undo((world,))
    changed, other = (array.ravel()[:1] for array in (world.poses.position, world.velocities.linear))
    was = changed.tobytes()
    changed[0] = np.nan
    undo.keep_what_changed()
    other[0] = 5.0
    undo()
    assert changed.tobytes() == was and other[0] == 5.0


@pytest.mark.parametrize(("name", "preset"), CASES)
def test_what_is_shown_does_not_know_of_the_rehearsal(name: str, preset: str) -> None:
    """Frames that were never rehearsed, compared with an engine that has been loaded."""
    scene = SCENES[name]
    engine = loaded(scene, preset, seed=3, record_inside=True)
    alone = Frames(build(scene), preset, Chosen(), 3, record=True, time_stages=False)
    for sample in lively(scene, 40):
        record = engine.advance(sample, DT)
        alone.frame(sample, DT)
        twin = alone.world
        assert record.counts == dict(alone.counts()) and record.shown.time == alone.time
        assert record.angles.tobytes() == twin.posture.angle[twin.hinges].tobytes()
        assert record.shown.velocities.tobytes() == twin.velocities.linear.tobytes()
        passed, steps = alone.passed, record.inside[:-1]
        # the last step is left out where it is the shown one
        assert len(passed) - len(steps) in (0, 1)
        assert [one.positions.tobytes() for one in steps] == [one.positions.tobytes() for one in passed[: len(steps)]]


def test_an_error_is_left_to_the_frame_that_meets_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """And the changes of the failed rehearsal are undone all the same."""
    whole = Frames.frame

    def fails(self: Frames, sample: TrackerSample, dt: float) -> None:
        whole(self, sample, dt)
        raise AvatarsimError("this frame fails")

    monkeypatch.setattr(Frames, "frame", fails)
    engine = AvatarsimEngine()
    first = engine.load(TOGETHER, Settings(), DT)
    assert first.shown.time == 0.0 and sum(engine.stage_calls().values()) == 0
    with pytest.raises(AvatarsimError, match="this frame fails"):
        engine.advance(TOGETHER.first_sample, DT)
    monkeypatch.undo()
    assert engine.load(TOGETHER, Settings(), DT).state_hash() == first.state_hash()


ASK = """
import json, os, sys

from avatarsim.engine import Settings
from avatarsim.jit.linking import CalledKernel
from avatarsim.simulator import AvatarsimEngine
from tests.late_kernels import CASES

for name, case in CASES.items():
    # a child of a process that has imported everything and loaded no kernel
    child = os.fork()
    if child:
        if os.waitpid(child, 0)[1]:
            sys.exit(1)
        continue
    engine = AvatarsimEngine()
    engine.load(case.scene, case.settings, case.dt)
    at_load, seen, late = CalledKernel.made, set(), []
    for k, sample in enumerate(case.samples):
        record = engine.advance(sample, case.dt)
        if CalledKernel.made > at_load + sum(late):
            late.append(CalledKernel.made - at_load - sum(late))
        seen |= {key for key, count in {**record.counts, **record.statuses}.items() if count}
        seen |= {one.event for one in record.inside}
        if case.sleeps(record):
            seen.add("sleep")
    print(json.dumps({"case": name, "at load": at_load, "late": late, "missing": sorted(set(case.happens) - seen)}), flush=True)
    os._exit(0)
"""


def test_no_kernel_comes_late_whatever_happens() -> None:
    """In fresh processes, through first contacts, impacts, searches, jumps and sleep: every kernel was there after `load`."""
    if not hasattr(os, "fork"):
        pytest.skip("this system does not fork")
    root = Path(__file__).parents[1]
    asked = subprocess.run([sys.executable, "-c", ASK], cwd=root, capture_output=True, text=True, timeout=300, check=False)
    assert asked.returncode == 0, asked.stderr
    answers = [json.loads(line) for line in asked.stdout.splitlines()]
    assert len(answers) >= 6
    for answer in answers:
        assert answer["missing"] == [], answer
        assert answer["at load"] > 0 and answer["late"] == [], answer
