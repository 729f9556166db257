"""What is packed comes back within half a step, and what is no number stays none."""

import math

import numpy as np
import pytest

from reports.replay import packed


def test_numbers_come_back() -> None:
    values = np.array([-1.0, 0.0, 0.123456, 3.0, math.nan, math.inf, 9.0])
    found = packed.unpacked(packed.text(packed.codes(values, (-1.0, 3.0))), (-1.0, 3.0))
    assert found[:4] == pytest.approx(values[:4], abs=0.5 * 4.0 / 65534 + 1e-12)
    assert np.isnan(found[4:6]).all() and found[6] == 3.0


def test_nothing_but_one_value() -> None:
    assert packed.unpacked(packed.text(packed.codes(np.zeros(3), (0.0, 0.0))), (0.0, 0.0)).tolist() == [0.0] * 3
