"""The gap of an avatar that touches is the median of known distances, and the judge's own in a scene."""

import math
from dataclasses import replace

import numpy as np
import pytest

from scenarios.measure.everything import measured
from scenarios.measure.known import Known
from scenarios.measure.posture.smoothness import contact_gap
from scenarios.measure.value import Missing
from tests.scenarios.examples import fist, fist_scene, walked


def test_gap_is_the_median_over_states_in_contact() -> None:
    assert contact_gap(np.array([0.2, 4e-3, -0.03, 2e-4, np.inf])) == {"contact_gap_p50": pytest.approx(2e-4)}
    assert contact_gap(np.array([-0.01, -0.02, 1e-3])) == {"contact_gap_p50": 0.0}
    assert math.isnan(float(contact_gap(np.array([1e-3, np.nan, 2e-3]))["contact_gap_p50"]))  # type: ignore[arg-type]
    assert isinstance(contact_gap(np.array([1.0, np.inf]))["contact_gap_p50"], Missing)


def test_only_everyday_scenes_have_a_gap() -> None:
    scene = fist_scene()
    recording = walked(30)
    assert "contact_gap_p50" not in measured(recording, Known(fist(), scene)).values
    assert measured(recording, Known(replace(fist(), everyday=True), scene)).values["contact_gap_p50"] == 0.0
