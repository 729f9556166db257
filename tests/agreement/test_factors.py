"""PyBullet's product rule: exact where possible, closest otherwise, and reported where it differs."""

import numpy as np
import pytest

from avatarsim.scene.body import ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Ellipsoid, Piece, Sphere
from reference.in_pybullet.unsupported import unsupported
from reference.minimax import CLOSE, least_worst
from reference.pair_factors import MISS, Array, coefficients, fit, fit_averages, missed, weights
from scenarios.catalog.paper.ball_drop import SCENARIO as BALL_DROP
from tests.agreement.scenes import hand, pressed

BALL = (Piece(Sphere(0.05)),)
MATERIALS = ("wood", "human", "metal")
KNOWN = {"restitution": 0.050, "friction": 0.033}
"""Largest error where all materials meet all, known to three decimals."""
HALF_A_DIGIT = 5e-4
GRID = 0.02
"""Step between two factors of the search."""
STEEPEST = 2.0
"""Largest change of a product of two factors up to 1 per change of both."""


def test_three_classes_that_touch_are_exact() -> None:
    """Hand, ball, table: 0.2, 0.2, 0.3 from factors 0.365, 0.548, 0.548."""
    table = fixed("table", (Piece(Box((1.0, 1.0, 0.05))),), "wood", (0.0, 0.0, -0.025))
    ball = simulated("ball", BALL, "wood", solid(BALL, 0.1), (0.0, 0.0, 0.05))
    scene = Scene("press", (table, ball), (hand(),), start=pressed(0))
    restitution, friction = (
        fit(scene, wanted, matters).values for wanted, matters in zip(coefficients(scene), weights(scene), strict=True)
    )
    assert restitution[0] * restitution[1] == pytest.approx(0.3, abs=1e-4)
    assert restitution[1] * restitution[2] == pytest.approx(0.2, abs=1e-4)
    assert friction[0] * friction[1] == pytest.approx(0.3, abs=1e-4)
    assert friction[1] * friction[2] == pytest.approx(0.2, abs=1e-4)
    assert friction[0] * friction[2] == pytest.approx(0.2, abs=1e-4)
    assert "restitution" not in unsupported(scene)


def test_six_balls_on_six_slabs_are_exact_where_they_meet() -> None:
    scene = BALL_DROP.build()
    values = fit(scene, coefficients(scene)[0], weights(scene)[0]).values
    for drop in BALL_DROP.expects["drops"]:  # type: ignore[attr-defined]
        product = values[scene.names.index(drop.ball)] * values[scene.names.index(drop.floor)]
        assert product == pytest.approx(drop.restitution, abs=2e-3)


def test_zero_stays_almost_zero_and_many_bodies_share_factors() -> None:
    bodies = tuple(simulated(f"b{k}", BALL, "wood", solid(BALL, 1.0), (0.2 * k, 0.0, 0.0)) for k in range(80))
    scene = Scene("many", bodies)
    values = fit(scene, coefficients(scene)[0], weights(scene)[0]).values
    assert np.ptp(values) < 1e-12
    assert values[0] ** 2 == pytest.approx(0.3, abs=1e-6)
    none = Scene("none", bodies, narrow=("restitution",))
    assert fit(none, coefficients(none)[0], weights(none)[0]).values.max() < 2e-3


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_factors_do_not_depend_on_the_size_of_the_world(scale: float) -> None:
    """Six balls on six slabs, in millimetres and in kilometres: the same pairs meet."""
    def balls(size: float) -> Scene:
        materials = [(a, b) for k, a in enumerate(MATERIALS) for b in MATERIALS[k:]]
        ball, slab = (Piece(Sphere(0.1 * size)),), (Piece(Box((0.6 * size, 0.6 * size, 0.2 * size))),)
        bodies = [fixed(f"slab_{k}", slab, b, (k * size, 0.0, 0.0)) for k, (_, b) in enumerate(materials)]
        return Scene("balls", (*bodies, *(
            simulated(f"ball_{k}", ball, a, solid(ball, 1.0), (k * size, 0.0, size)) for k, (a, _) in enumerate(materials)
        )))

    for usual, there in zip(*((coefficients(s), weights(s)) for s in (balls(1.0), balls(scale))), strict=True):
        np.testing.assert_allclose(usual, there, rtol=1e-9)


def test_ellipsoids_are_reported_as_unsupported() -> None:
    egg = (Piece(Ellipsoid((0.1, 0.2, 0.3))),)
    scene = Scene("egg", (simulated("egg", egg, "wood", solid(egg, 1.0)),))
    assert "ellipsoids" in unsupported(scene)


@pytest.mark.parametrize("what", [0, 1], ids=list(KNOWN))
def test_table_1_is_missed_by_no_more_than_known(what: int) -> None:
    """Return two balls of each material, all at one position."""
    bodies = tuple(simulated(f"{material}_{k}", BALL, material, solid(BALL, 1.0)) for material in MATERIALS for k in range(2))
    scene = Scene("crowd", bodies)
    found = fit(scene, coefficients(scene)[what], weights(scene)[what])
    worst = max(abs(wanted - said) for _, _, wanted, said in found.misses)
    assert worst <= list(KNOWN.values())[what] + HALF_A_DIGIT
    assert list(KNOWN)[what] in unsupported(scene)


def tried(first: np.ndarray, second: np.ndarray, wanted: Array, weight: Array) -> float:
    """Return the smallest maximum of the weighted errors over all triples of factors on a grid."""
    steps = np.arange(GRID, 1.0 + GRID, GRID)
    factors = np.stack(np.meshgrid(steps, steps, steps, indexing="ij")).reshape(3, -1)
    return float((weight[:, None] * np.abs(factors[first] * factors[second] - wanted[:, None])).max(axis=0).min())


@pytest.mark.parametrize("seed", range(8))
def test_no_factors_of_a_grid_are_better(seed: int) -> None:
    """Any table of three materials, any weights, and a first guess that is far off."""
    draw = np.random.default_rng(seed)
    first, second = np.triu_indices(3)
    wanted, weight = draw.uniform(0.05, 0.9, 6), draw.uniform(0.1, 1.0, 6)
    logs = least_worst(first, second, wanted, weight, np.log(np.full(3, 0.9)))
    worst = float((weight * np.abs(np.exp(logs[first] + logs[second]) - wanted)).max())
    best = tried(first, second, wanted, weight)
    assert best - STEEPEST * GRID <= worst <= best + CLOSE


@pytest.mark.parametrize(("table", "exact"), [((0.5, 0.4, 0.3), True), ((0.9, 0.0, 0.0), False)])
def test_averages_of_three_are_exact_where_factors_can_be(table: tuple[float, ...], exact: bool) -> None:
    laws = dict(zip((("a", "b"), ("a", "c"), ("b", "c")), table, strict=True)) | {(name, name): 0.2 for name in "abc"}
    bodies = tuple(simulated(name, BALL, name, solid(BALL, 1.0)) for name in "abc")
    scene = Scene("three", bodies, materials=PairTable({pair: ContactLaw(e, 0.1) for pair, e in laws.items()}))
    wanted = coefficients(scene)[0]
    factors = fit_averages(scene, wanted, weights(scene)[0])
    said = 0.5 * (factors.values[:, None] + factors.values[None])
    off = np.abs(said - wanted)[np.triu_indices(3, 1)].max()
    assert factors.values.min() >= 0.0
    assert (off <= MISS) == exact == (factors.misses == ()) == ("restitution" not in missed(scene, averages=True))
