"""Shortfall of bodies that are pushed along a stated way."""

from dataclasses import replace

import numpy as np

from scenarios.measure.bodies.whereabouts import travel
from tests.scenarios.examples import drop, drop_scene, resting


def _moved(way: float) -> dict[str, float]:
    recording = resting(drop_scene(), 5)
    positions = recording.positions.copy()
    body = drop_scene().names.index("ball")
    positions[3:, body] += np.array([0.6, 0.0, 0.8]) * way
    scenario = replace(drop(5), expects={"travel": {"ball": 0.5}})
    return dict(travel(replace(recording, positions=positions), scenario, drop_scene()))


def test_the_shortfall_of_a_stated_way_is_the_figure() -> None:
    assert np.isclose(_moved(0.125)["travel_missing"], 0.375)
    assert _moved(0.0)["travel_missing"] == 0.5


def test_going_farther_is_no_shortfall() -> None:
    assert _moved(2.0)["travel_missing"] == 0.0


def test_a_scene_that_states_no_way_says_nothing() -> None:
    assert travel(resting(drop_scene(), 5), drop(5), drop_scene()) == {}


def test_places_that_are_not_numbers_are_no_way() -> None:
    recording = resting(drop_scene(), 5)
    positions = recording.positions.copy()
    positions[2:, drop_scene().names.index("ball")] = np.nan
    scenario = replace(drop(5), expects={"travel": {"ball": 0.5}})
    assert travel(replace(recording, positions=positions), scenario, drop_scene()) == {"travel_missing": 0.5}
