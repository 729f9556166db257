"""All metrics together: none is reported where a scene has no case for it, and figures of absent packages are missing."""

import sys
from dataclasses import replace

import pytest

from avatarsim.scene.scene import Scene
from scenarios.measure.everything import measured
from scenarios.measure.known import Known
from scenarios.measure.value import Missing
from scenarios.scenario import EXPECTS
from tests.scenarios.examples import drop, drop_scene, fist, fist_scene, resting

SHOWN = {
    "not_finite_frames", "overlap_frames", "residual_overlap_max", "residual_overlap_mean", "residual_overlap_p95",
    "substep_overlap_max",
}
"""Figures that every scene has."""
LOOSE = {
    "energy_added_max", "lift_energy_max", "lift_height_max", "halted_frames", "status_frames", "stalled_bodies",
    "time_kept_error",
}
POSTURE = {
    "root_jump_max", "pose_jump_max", "still_frames", "tracker_offset_rms", "tracker_angle_rms", "chatter_frames", "free_frames",
}


@pytest.mark.parametrize(("scene", "among", "absent"), [
    (Scene("fixed", drop_scene().bodies[:1]), SHOWN, LOOSE | POSTURE), (drop_scene(), SHOWN | LOOSE, POSTURE),
    (fist_scene(), SHOWN | POSTURE, LOOSE),
], ids=["fixed bodies", "a loose body", "an avatar"])
def test_a_scene_has_no_figures_of_what_it_has_not(scene: Scene, among: set[str], absent: set[str]) -> None:
    found = measured(resting(scene, 3), Known(replace(drop(3), expects={}, bounds=()), scene)).values
    stated = {metric for _, metrics in EXPECTS.values() for metric in metrics}
    assert among <= set(found) and not (absent | stated | {"wrong_side_frames", "escaped_bodies"}) & set(found)


def test_without_the_judge_its_figures_are_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "reference.judging.judge", None)
    values = measured(resting(fist_scene(), 2), Known(fist(2), fist_scene())).values
    overlap = values["residual_overlap_max"]
    assert isinstance(overlap, Missing) and overlap.fault == "package"
    assert values["not_finite_frames"] == 0.0
