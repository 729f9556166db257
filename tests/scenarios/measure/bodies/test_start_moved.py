"""Distance that bodies are moved at a start that overlaps."""

from dataclasses import replace

import pytest

from scenarios.measure.bodies.whereabouts import start_moved
from scenarios.scenario import REFUSAL
from tests.scenarios.examples import drop, drop_scene, resting


def test_the_farthest_move_of_the_first_state_is_the_figure() -> None:
    recording, scenario = resting(drop_scene(), 5), replace(drop(5), expects={REFUSAL: True})
    positions = recording.positions.copy()
    positions[0, drop_scene().names.index("ball")] += (0.3, 0.0, 0.4)
    positions[1:] += 9.0
    found = start_moved(replace(recording, positions=positions), scenario, drop_scene())
    assert found["start_moved_max"] == pytest.approx(0.5)


def test_a_scene_that_begins_free_has_no_such_figure() -> None:
    assert start_moved(resting(drop_scene(), 5), drop(5), drop_scene()) == {}
