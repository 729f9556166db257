"""Products of three factors come as close to Table 1 as any can, at worst: by trying all factors of a grid."""

import numpy as np
import pytest

from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from reference.in_pybullet.cannot_say import cannot_say
from reference.in_pybullet.factors import Array, coefficients, fit, weights
from reference.in_pybullet.minimax import CLOSE, least_worst

MATERIALS = ("wood", "human", "metal")
KNOWN = {"restitution": 0.050, "friction": 0.033}
"""Largest miss where all materials meet all, known to three decimals."""
HALF_A_DIGIT = 5e-4
GRID = 0.02
"""Between two factors that are tried."""
STEEPEST = 2.0
"""Of a product of two factors up to 1, against both."""


@pytest.mark.parametrize("what", [0, 1], ids=list(KNOWN))
def test_table_1_is_missed_by_no_more_than_known_where_all_meet_all(what: int) -> None:
    """Two balls of each material, all in one place."""
    ball = (Piece(Sphere(0.05)),)
    bodies = tuple(simulated(f"{material}_{k}", ball, material, solid(ball, 1.0)) for material in MATERIALS for k in range(2))
    scene = Scene("crowd", bodies)
    found = fit(scene, coefficients(scene)[what], weights(scene)[what])
    worst = max(abs(wanted - said) for _, _, wanted, said in found.misses)
    assert worst <= list(KNOWN.values())[what] + HALF_A_DIGIT
    assert list(KNOWN)[what] in cannot_say(scene)


def tried(first: Array, second: Array, wanted: Array, weight: Array) -> float:
    """The smallest of the largest weighted misses, of all triples of factors on a grid."""
    steps = np.arange(GRID, 1.0 + GRID, GRID)
    factors = np.stack(np.meshgrid(steps, steps, steps, indexing="ij")).reshape(3, -1)
    return float((weight[:, None] * np.abs(factors[first] * factors[second] - wanted[:, None])).max(axis=0).min())


@pytest.mark.parametrize("seed", range(8))
def test_no_factors_of_a_grid_are_better(seed: int) -> None:
    """Any table of three materials, any weights, and a guess that is far off."""
    draw = np.random.default_rng(seed)
    first, second = np.triu_indices(3)
    wanted, weight = draw.uniform(0.05, 0.9, 6), draw.uniform(0.1, 1.0, 6)
    logs = least_worst(first, second, wanted, weight, np.log(np.full(3, 0.9)))
    worst = float((weight * np.abs(np.exp(logs[first] + logs[second]) - wanted)).max())
    best = tried(first, second, wanted, weight)
    assert best - STEEPEST * GRID <= worst <= best + CLOSE


def test_factors_are_found_from_their_products() -> None:
    """Factors of 0.3, 0.5, 0.8 and 1 from their products."""
    factors = np.array([0.3, 0.5, 0.8, 1.0])
    first, second = np.triu_indices(4, 1)
    logs = least_worst(first, second, factors[first] * factors[second], np.full(6, 0.5), np.zeros(4))
    np.testing.assert_allclose(np.exp(logs), factors, atol=10.0 * CLOSE)
