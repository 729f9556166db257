"""What counts as a gain of energy."""

import numpy as np
import pytest

from avatarsim.rigid.energy_audit import take_back

HELD = np.array([0, 1])


@pytest.mark.nojit
@pytest.mark.parametrize(("gain", "kinetic", "taken"), [
    (5e-14, 1.0, False), (5e-14, 6e-5, True), (2e-13, 1.0, True), (1e-15, 6e-5, False), (-1.0, 1.0, False), (1.0, 0.0, False),
])
def test_a_gain_is_rounding_only_beside_the_energy_that_there_is(gain: float, kinetic: float, taken: bool) -> None:
    """5e-14 J is nothing to a body of a kilogram at 1 m/s, and a part in 1e9 of a world of millimetres."""
    linear, angular = np.ones((2, 3)), np.ones((2, 3))
    assert take_back(gain, kinetic, np.array([0, 1]), HELD, linear, angular) == taken
    np.testing.assert_array_equal(linear[0], 1.0)
    np.testing.assert_allclose(linear[1] ** 2, 1.0 - gain / kinetic if taken else 1.0, rtol=1e-15)
