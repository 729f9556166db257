"""Phases of a frame from what was shown: a ball that falls, meets the floor and lies there; a hand held off its target."""

from dataclasses import replace

import numpy as np
import pytest

from scenarios import catalog
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.measure.phases import ELSEWHERE, phases
from scenarios.record import Recording
from scenarios.run import gathered
from tests.scenarios.examples import fist_scene, resting


def of_ball_drop(engine: str, preset: str) -> tuple[Recording, tuple[str, ...]]:
    job = Job("ball_drop", engine, preset)
    scenario, scene, motion = job.asked()
    one = opened(engine)
    samples = [motion(k) for k in range(scenario.frames)]
    frames = [one.load(scene, job.settings(one), scenario.dt), *(one.advance(sample, scenario.dt) for sample in samples)]
    one.close()
    recording = gathered(job, scenario, scene, [scene.first_sample, *samples], frames, {})
    return recording, phases(recording, scene)


@pytest.mark.parametrize(("engine", "preset"), [("avatarsim", "default"), ("mujoco", "tuned")])
def test_a_ball_flies_before_it_meets_the_floor(engine: str, preset: str) -> None:
    recording, found = of_ball_drop(engine, preset)
    assert len(found) == recording.frames == catalog.get("ball_drop").as_run(False).frames
    first = found.index("contact")
    assert first > 10 and set(found[:first]) == {"free"}


def test_what_does_not_move_rests_and_what_is_off_its_target_is_in_contact() -> None:
    still = resting(fist_scene(), 5)
    assert set(phases(still, fist_scene())) == {"rest"}
    moved = still.positions.copy()
    moved[:, still.links] += np.arange(6)[:, None, None] * np.array([2e-3, 0.0, 0.0])
    held = replace(still, positions=moved)
    off = np.linalg.norm(moved[1:, still.links] - still.raw_positions[1:], axis=-1).max(axis=1) > ELSEWHERE
    assert phases(held, fist_scene()) == tuple("contact" if away else "free" for away in off)
    led = replace(held, raw_positions=still.raw_positions + (moved - still.positions)[:, still.links])
    assert set(phases(led, fist_scene())) == {"free"}


def test_a_place_that_is_no_number_is_not_at_rest() -> None:
    still = resting(fist_scene(), 3)
    broken = still.positions.copy()
    broken[2] = np.nan
    assert "rest" not in phases(replace(still, positions=broken), fist_scene())[1:]
