"""Table 1: every pair of materials bounces and slides with its own two coefficients."""

import numpy as np
import pytest

from avatarsim.scene.body import TABLE_1
from tests.rigid.upper_world import G, World, ball, slab

PRINTED = {
    ("wood", "wood"): (0.3, 0.3), ("wood", "human"): (0.2, 0.2), ("wood", "metal"): (0.2, 0.1),
    ("human", "human"): (0.1, 0.1), ("human", "metal"): (0.2, 0.1), ("metal", "metal"): (0.3, 0.1),
}


@pytest.mark.parametrize(("one", "other"), [*PRINTED, *[(b, a) for a, b in PRINTED if a != b]])
@pytest.mark.parametrize("rate", [30.0, 60.0, 1000.0])
def test_pair(one: str, other: str, rate: float) -> None:
    """A ball thrown flat onto a slab: v+/v- is the pair's restitution, the loss of slip its friction."""
    e, mu = PRINTED.get((one, other)) or PRINTED[other, one]
    flier = ball("ball", (0.0, 0.0, 0.5), material=other, velocity=(8.0, 0.0, 0.0))
    world = World([slab(material=one), flier], materials=TABLE_1)
    while not world.impacts:
        assert world.frame(1.0 / rate) == 0
    _, _, before, _, after, _ = world.impacts[0]
    assert before[1, 2] == pytest.approx(-np.sqrt(2.0 * G * 0.4), abs=1e-6)
    assert after[1, 2] / before[1, 2] == pytest.approx(-e, abs=1e-9)
    assert (before[1, 0] - after[1, 0]) / ((1.0 + e) * -before[1, 2]) == pytest.approx(mu, abs=1e-9)
