"""Final positions: outside a region, short of a stated distance, fallen out of a hand, moved by a start that overlaps."""

from dataclasses import replace

import numpy as np
import pytest

from scenarios.measure.bodies.whereabouts import escapes, grasp, start_moved, travel
from scenarios.scenario import REFUSAL, Region
from tests.scenarios.examples import drop, drop_scene, resting

NAN = np.full(3, np.nan)


def of(measure: object, metric: str, by: np.ndarray, **expects: object) -> float:
    """Return the only figure, a `metric`, of a ball displaced `by` from its start in the last frames."""
    recording = resting(drop_scene(), 5)
    recording.positions[3:, drop_scene().names.index("ball")] += by
    region = Region(("ball", "slab"), (-1.0, -1.0, -1.0), (0.2, 1.0, 2.0), "because")
    found = measure(recording, replace(drop(5), expects=expects, regions=(region,)), drop_scene())  # type: ignore[operator]
    assert list(found) == [metric]
    return float(found[metric])


@pytest.mark.parametrize(("way", "missing"), [
    (np.array([0.075, 0.0, 0.1]), 0.375), (np.zeros(3), 0.5), (np.array([1.2, 0.0, 1.6]), 0.0), (NAN, 0.5),
])
def test_the_shortfall_of_a_stated_way_is_the_figure(way: np.ndarray, missing: float) -> None:
    assert of(travel, "travel_missing", way, travel={"ball": 0.5}) == pytest.approx(missing)


@pytest.mark.parametrize(("lower", "fallen"), [(0.75, 0.75), (-0.2, 0.0), (np.nan, np.nan)])
def test_what_slips_out_of_a_hand_has_fallen_by_its_height(lower: float, fallen: float) -> None:
    assert of(grasp, "grasped_fall_end", np.array([0.3, 0.0, -lower]), grasped=("ball",)) == pytest.approx(fallen, nan_ok=True)


@pytest.mark.parametrize(("way", "share"), [(np.array([0.3, 0.0, 0.0]), 50.0), (np.array([0.1, 0.0, 0.0]), 0.0), (NAN, 50.0)])
def test_the_share_of_bodies_that_left_their_region(way: np.ndarray, share: float) -> None:
    assert of(escapes, "escaped_bodies", way) == share


def test_the_farthest_move_of_the_first_state_is_the_figure() -> None:
    recording = resting(drop_scene(), 5)
    recording.positions[0, drop_scene().names.index("ball")] += (0.3, 0.0, 0.4)
    recording.positions[1:] += 9.0
    found = start_moved(recording, replace(drop(5), expects={REFUSAL: True}), drop_scene())
    assert found == {"start_moved_max": pytest.approx(0.5)}
