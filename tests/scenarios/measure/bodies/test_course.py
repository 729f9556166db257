"""Courses, stops, drift, halts and towers against closed forms, from recordings made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from runfiles.record import Recording
from scenarios.building.expected import Course, Pile, Rest, Stop, Tower, steady, uniform
from scenarios.measure.bodies.closed_form import course_errors, stops
from scenarios.measure.bodies.standing import at_rest, piles, towers
from scenarios.measure.frames import halts
from scenarios.measure.value import Missing
from tests.scenarios.examples import DT, drop, drop_scene, expecting, resting

BALL = 1
HEIGHT = float(resting(drop_scene(), 1).positions[0, BALL, 2])


def moved(velocity: tuple[float, float, float], frames: int = 30) -> Recording:
    """Return a recording of the ball in uniform motion."""
    recording = resting(drop_scene(), frames)
    recording.positions[:, BALL] += recording.times[:, None] * np.array(velocity)
    recording.velocities[:, BALL] = velocity
    return recording


def test_the_farthest_from_the_course_is_the_figure() -> None:
    course = Course("ball", uniform((0.0, 0.0, 1.1), (2.0, 0.0, 0.0)), steady(2.0, 0.0, 0.5), steady(0.0, 0.3, 0.4))
    found = course_errors(moved((2.0, 0.0, 0.5)), expecting(30, courses=(course,)), drop_scene())
    assert found["course_error_max"] == pytest.approx(0.5 * 30 * DT)
    assert found["velocity_error_max"] == 0.0 and found["spin_error_max"] == pytest.approx(0.5)


def test_course_counts_only_in_its_stated_time() -> None:
    course = Course("ball", velocity=steady(1.0, 0.0, 0.0), since=0.2, until=0.3)
    recording = moved((1.0, 0.0, 0.0))
    recording.velocities[:12, BALL] = recording.velocities[19:, BALL] = 9.0
    assert course_errors(recording, expecting(30, courses=(course,)), drop_scene()) == {"velocity_error_max": 0.0}
    early = course_errors(moved((1.0, 0.0, 0.0), 5), expecting(30, courses=(course,)), drop_scene())["velocity_error_max"]
    assert isinstance(early, Missing) and early.fault == "scene"


def test_a_course_through_what_is_no_number_is_no_number() -> None:
    recording = moved((0.0, 0.0, 0.0))
    recording.positions[7, BALL, 0] = np.nan
    course = Course("ball", steady(0.0, 0.0, 1.1))
    found = course_errors(recording, expecting(30, courses=(course,)), drop_scene())
    assert found["course_error_max"] == pytest.approx(np.nan, nan_ok=True)


def test_drift_is_from_rest_and_energy_is_that_of_the_end() -> None:
    found = at_rest(moved((0.0, 0.3, 0.0)), expecting(30, rests=(Rest(("ball",), 0.1),)), drop_scene())
    assert found["drift_max"] == pytest.approx(0.3 * (30 - 6) * DT)
    # the ball has 2 kg
    assert found["rest_energy_end"] == pytest.approx(0.09)


def test_stop_is_compared_by_distance_and_direction() -> None:
    stop = Stop("ball", 1.0, (1.0, 0.0, 0.0), 0.4)
    found = stops(moved((1.8, 0.018, 0.0)), expecting(30, stops=(stop,)), drop_scene())
    assert found["stop_distance_error_max"] == pytest.approx(10.0)
    assert found["stop_direction_error_max"] == pytest.approx(np.degrees(0.01), rel=1e-4)
    still = stops(moved((0.0, 0.0, 0.0)), expecting(30, stops=(stop,)), drop_scene())
    assert still == {"stop_distance_error_max": 100.0, "stop_direction_error_max": 90.0}


def test_a_body_with_speed_that_stays_is_a_halt() -> None:
    recording = moved((1.0, 0.0, 0.0))
    recording.positions[11:14, BALL] = recording.positions[10, BALL]
    status = np.zeros(31, dtype=np.int64)
    status[4] = 2
    found = halts(replace(recording, statuses={"motion out of segments": status}), drop_scene())
    assert found == {"halted_frames": 3.0, "status_frames": 1.0}
    assert halts(moved((0.0, 0.0, 0.0)), drop_scene()) == {"halted_frames": 0.0, "status_frames": 0.0}


def test_towers_stand_up_to_the_first_ratio_that_falls() -> None:
    def of(*places: float) -> tuple[Tower, ...]:
        return tuple(Tower("ball", 10.0**k, (x, 0.0, HEIGHT), 0.2) for k, x in enumerate(places))

    still = moved((0.0, 0.0, 0.0))
    asked = ((0.0, 0.0009), 0.0, 10.0), ((0.0, 0.0011, 0.0), 1.0, 1.0), ((0.002, 0.0), 1.0, 0.0)
    for places, fallen, stands in asked:
        found = towers(still, expecting(30, towers=of(*places)), drop_scene())
        assert found == {"towers_fallen": fallen, "ratio_standing_max": stands}
    # it is inside at first, and leaves
    assert towers(moved((1.0, 0.0, 0.0)), expecting(30, towers=of(0.0)), drop_scene())["towers_fallen"] == 1.0
    nowhere = replace(still, positions=np.full_like(still.positions, np.nan))
    assert towers(nowhere, expecting(30, towers=of(0.0)), drop_scene())["towers_fallen"] == 1.0
    assert towers(still, drop(30), drop_scene()) == {}


def test_pile_height_is_the_mean_above_its_floor() -> None:
    pile = Pile(("ball",), "slab", 1.0, 0.2)
    recording = moved((0.0, 0.0, 0.0))
    recording.positions[:, BALL, 2] = recording.positions[0, 0, 2] + 1.25
    recording.positions[: round(0.2 / DT), BALL, 2] = 9.0
    assert piles(recording, expecting(30, piles=(pile,)), drop_scene())["pile_height_error_max"] == pytest.approx(25.0)
    recording.positions[-1, BALL, 2] -= 0.75
    assert piles(recording, expecting(30, piles=(pile,)), drop_scene())["pile_height_error_max"] == pytest.approx(50.0)
    early = piles(moved((0.0, 0.0, 0.0), 5), expecting(30, piles=(pile,)), drop_scene())["pile_height_error_max"]
    assert isinstance(early, Missing) and early.fault == "scene"
    assert piles(recording, expecting(30), drop_scene()) == {}
