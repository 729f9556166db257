"""Frames divided into parts: equal motion, equal length, samples between samples."""

import numpy as np
import pytest

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.tracker import checked, link_poses
from reference.targets import Targets
from scenarios import catalog
from scenarios.studies.settings import finer


def test_it_takes_as_long_and_passes_through_every_sample() -> None:
    whole, cut = catalog.get("driven_10cm_wall"), finer.get("driven_10cm_wall~4")
    assert cut.frames == 4 * whole.frames and cut.dt == whole.dt / 4 and cut.short is None
    scene = whole.build()
    coarse, fine = whole.motion(scene, 0), cut.motion(scene, 0)
    for k in (0, 7, 60):
        np.testing.assert_array_equal(fine(4 * k + 3).positions, coarse(k).positions)
        assert fine(4 * k + 3).time == coarse(k).time


def test_parts_between_samples_are_the_targets_of_engines() -> None:
    whole, cut = catalog.get("mocap_punch_wall"), finer.get("mocap_punch_wall~8")
    scene = whole.build()
    coarse, fine, targets = whole.motion(scene, 0), cut.motion(scene, 0), Targets(scene, clamp=False)
    goals = targets.between(coarse(40), coarse(41), np.arange(9) / 8)
    for part in (1, 4, 7):
        sample = checked(fine(8 * 41 + part - 1), scene.avatars)
        np.testing.assert_allclose(link_poses(scene.avatars, sample)[0], goals.positions[part], atol=1e-12)
        assert sample.time == pytest.approx(coarse(40).time + part / 8 * (coarse(41).time - coarse(40).time), abs=1e-12)


def test_short_runs_and_scenes_without_avatar() -> None:
    whole, cut = catalog.get("stack_ten"), finer.get("stack_ten~2")
    assert whole.short is not None and cut.short == 2 * whole.short
    scene = whole.build()
    sample = cut.motion(scene, 0)(0)
    assert sample.time == pytest.approx(whole.dt / 2) and sample.positions.shape == (0, 3)


@pytest.mark.parametrize("name", ["stack_ten", "stack_ten~0", "stack_ten~-2", "stack_ten~1.5", "stack_ten~9999", "stack_ten~"])
def test_parts_that_make_no_sense_and_unknown_scenes_are_refused(name: str) -> None:
    with pytest.raises(InvalidInput, match="parts of a frame"):
        finer.get(name)
    with pytest.raises(UnknownName):
        finer.get("nowhere~2")
