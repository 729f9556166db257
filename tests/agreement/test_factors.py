"""PyBullet's product rule: exact where it can be, closest where it cannot, and honest about the difference."""

import numpy as np
import pytest

from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Ellipsoid, Piece, Sphere
from reference.in_pybullet.cannot_say import cannot_say
from reference.in_pybullet.factors import coefficients, fit, weights
from scenarios.catalog.paper.ball_drop import SCENARIO as BALL_DROP
from tests.agreement.scenes import hand, pressed

BALL = (Piece(Sphere(0.05)),)


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
    assert "restitution" not in cannot_say(scene)


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
        materials = [(a, b) for k, a in enumerate(("wood", "human", "metal")) for b in ("wood", "human", "metal")[k:]]
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
    assert "ellipsoids" in cannot_say(scene)
