"""MuJoCo's convex friction cone: a body that still slides after an impact is lifted by friction times the remaining slip.
Not so if friction is solved after the normal forces. Bodies that do not bounce are pushed out by the position correction.
"""

from math import cos, radians, sin

import numpy as np
import pytest

from avatarsim.engine import Settings
from reference.in_mujoco.engine import MujocoEngine
from scenarios.catalog.impacts.plate import RESTITUTION, SPEED, after
from tests.agreement.runs import of_catalog

SLIDES = [(45.0, 0.1), (70.0, 0.1), (70.0, 0.3)]
"""Angles [deg] and frictions of oblique_bounce at which the sphere still slides when it leaves."""
ROUND = 3.5
"""Change of a solid sphere's slip per change of its velocity: 1 + m r^2 / I."""
CONVEX: dict[str, object] = {"impratio": 1.0, "noslip_iterations": 0}


def left_with(name: str, options: dict[str, object]) -> dict[str, np.ndarray]:
    """Return the velocity (3,) [m/s] of every body at the end of a scene, by name, with the tuned settings and `options`."""
    scene, records = of_catalog(MujocoEngine(), name, Settings("tuned", options))
    return dict(zip(scene.names, records[-1].shown.velocities, strict=True))


def lifted(angle: float, friction: float) -> float:
    """Return v_n' of the convex law: v_n' = e v_n + mu s' with the remaining slip s' = s - 3.5 mu (v_n + v_n')."""
    normal, slip = SPEED * cos(radians(angle)), SPEED * sin(radians(angle))
    left = (slip - ROUND * friction * (1.0 + RESTITUTION) * normal) / (1.0 + ROUND * friction**2)
    return RESTITUTION * normal + friction * left


def test_a_convex_cone_lifts_what_slides_on() -> None:
    convex, apart = left_with("oblique_bounce", CONVEX), left_with("oblique_bounce", {})
    for angle, friction in SLIDES:
        ball, right = f"ball_{angle:g}_{friction:g}", after(angle, friction)
        assert convex[ball][2] == pytest.approx(lifted(angle, friction), abs=0.02)
        assert apart[ball][2] == pytest.approx(right.normal, abs=0.02)
        assert apart[ball][0] == pytest.approx(right.tangential, abs=0.02)


@pytest.mark.parametrize("kappa", [0.0, 0.1])
def test_position_correction_parts_what_does_not_bounce(kappa: float) -> None:
    """Two spheres of equal mass at 2 m/s: afterwards together at 1 m/s, or separating by up to kappa times 2 m/s."""
    shown = left_with("two_spheres", {"kappa_resting": kappa, "dt": 1.0 / 960.0})
    apart = shown["waits_1_0"][0] - shown["comes_1_0"][0]
    assert apart == pytest.approx(2.0 * kappa, abs=1e-6 + 0.5 * kappa)
