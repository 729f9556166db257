"""Figures go into a recording's meta and come out as they were; what others wrote there is refused."""

import json
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import InvalidFile
from runfiles.files import plain
from runfiles.record import Recording
from scenarios.measure.value import Missing, Value
from scenarios.run.figures import figures, told
from tests.scenarios.examples import drop_scene, resting

VALUES: dict[str, Value] = {
    "third": 1.0 / 3.0, "numpy": float(np.float64(0.1)), "none": float("nan"), "far": float("-inf"), "minus zero": -0.0,
    "tiny": 5e-324, "absent": Missing("it never came down", "engine"),
}


def holding(meta: dict[str, object], overlap: int = 0) -> Recording:
    """A recording whose meta has been through a file."""
    return replace(resting(drop_scene(), 3), meta=json.loads(json.dumps(plain(meta))), overlap=np.zeros(overlap))


def test_figures_come_back_to_the_last_bit() -> None:
    values, notes = figures(holding(told(VALUES, {"third": "every 3rd"})))
    assert repr(values) == repr(VALUES) and notes == {"third": "every 3rd"}


@pytest.mark.parametrize(("meta", "overlap"), [
    ({}, 0), ({"figures": []}, 0), ({"figures": {}, "notes": 3}, 0), ({"figures": {"a": True}, "notes": {}}, 0),
    ({"figures": {"a": "1.0"}, "notes": {}}, 0), ({"figures": {"a": ["why", "weather"]}, "notes": {}}, 0),
    ({"figures": {"a": ["why"]}, "notes": {}}, 0), ({"figures": {"a": None}, "notes": {}}, 0), ({"figures": {}, "notes": {}}, 2),
])
def test_what_is_no_figure_is_an_invalid_file(meta: dict[str, object], overlap: int) -> None:
    with pytest.raises(InvalidFile, match="recording"):
        figures(holding(meta, overlap))
