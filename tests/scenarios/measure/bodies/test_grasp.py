"""Grasps: how far a body has fallen out of a hand."""

from dataclasses import replace

import numpy as np
import pytest

from scenarios.catalog.driven import hand_grasp
from scenarios.measure.bodies.whereabouts import grasp
from tests.scenarios.examples import drop, drop_scene, resting


def fallen(way: float) -> float:
    recording, scene = resting(drop_scene(), 5), drop_scene()
    positions = recording.positions.copy()
    positions[3:, scene.names.index("ball")] += np.array([0.3, 0.0, -way])
    scenario = replace(drop(5), expects={"grasped": ("ball",)})
    return float(str(grasp(replace(recording, positions=positions), scenario, scene)["grasped_fall_end"]))


def test_what_slips_out_has_fallen_by_its_height() -> None:
    """grasped_fall_end is what a body is lower in the end, whatever it did before and aside."""
    assert fallen(0.75) == pytest.approx(0.75)
    assert fallen(-0.2) == 0.0, "what is lifted has not fallen"
    assert np.isnan(fallen(np.nan))


def test_scenes_without_a_grasp_say_nothing_and_the_mug_is_one() -> None:
    assert grasp(resting(drop_scene(), 5), drop(5), drop_scene()) == {}
    assert hand_grasp.SCENARIO.expects["grasped"] == ("mug",)
