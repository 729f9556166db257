"""Eq. 10: friction in an impact, as printed and limited to sticking contacts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.rigid.contact_law import friction_impulse, limited_friction_impulse
from tests.rigid.upper_world import World, ball, slab

vectors = st.tuples(*[st.floats(-5.0, 5.0)] * 3)


@given(st.floats(0.0, 2.0), st.floats(0.0, 10.0), vectors)
def test_as_printed(mu: float, j: float, v_t: tuple[float, float, float]) -> None:
    """Size mu j, against the slip; no slip, no friction."""
    j_t = np.array(friction_impulse(mu, j, v_t))
    slip = float(np.linalg.norm(v_t))
    np.testing.assert_allclose(j_t * slip, -mu * j * np.array(v_t), atol=1e-9)


@given(st.floats(0.0, 2.0), st.floats(0.0, 10.0), vectors, st.floats(0.0, 10.0))
def test_the_limit_only_shortens(mu: float, j: float, v_t: tuple[float, float, float], sticking: float) -> None:
    """Never larger than either figure, same direction."""
    limited, printed = np.array(limited_friction_impulse(mu, j, v_t, sticking)), np.array(friction_impulse(mu, j, v_t))
    assert np.linalg.norm(limited) <= min(float(np.linalg.norm(printed)), sticking) + 1e-12
    np.testing.assert_allclose(np.cross(limited, printed), 0.0, atol=1e-9)


def oblique(degrees: float, mu: float, e: float, paper: bool = False) -> tuple[World, float, float]:
    """Return a 5 m/s ball that comes down at an angle; its world after the impact, and the two parts of its speed before."""
    angle = np.radians(degrees)
    vt, vn = 5.0 * np.cos(angle), 5.0 * np.sin(angle)
    flier = ball("ball", (0.0, 0.0, 0.3), velocity=(vt, 0.0, -vn))
    world = World([slab(), flier], e, mu, gravity=(0.0, 0.0, 0.0))
    while not world.impacts:
        assert world.frame(paper=paper) == 0
    return world, vt, vn


@pytest.mark.parametrize("degrees", [20.0, 45.0, 70.0])
@pytest.mark.parametrize("mu", [0.1, 0.3, 1.0])
@pytest.mark.parametrize("e", [0.0, 0.5, 0.9])
def test_oblique_sphere_sticks_or_slides(degrees: float, mu: float, e: float) -> None:
    """Sticks if mu (1 + e) v_n >= 2/7 v_t: then v_t' = 5/7 v_t; else v_t' = v_t - mu (1 + e) v_n and w' = 5 mu (1 + e) v_n /
    2r."""
    world, vt, vn = oblique(degrees, mu, e)
    _, _, _, _, after, spin = world.impacts[0]
    drag = min(mu * (1.0 + e) * vn, 2.0 / 7.0 * vt)
    np.testing.assert_allclose(after[1], [vt - drag, 0.0, e * vn], atol=1e-9)
    assert spin[1, 1] == pytest.approx(2.5 * drag / 0.1, abs=1e-9)


def test_as_printed_it_reverses_the_slip_and_may_add_energy() -> None:
    """The method `paper` keeps the printed equation: mu (1 + e) v_n = 7.05 m/s takes a slip of 1.7 m/s far beyond zero."""
    world, vt, vn = oblique(70.0, 1.0, 0.5, paper=True)
    _, _, before, _, after, spin = world.impacts[0]
    assert after[1, 0] == pytest.approx(vt - 1.5 * vn, abs=1e-9)
    slip = after[1, 0] - 0.1 * spin[1, 1]
    assert slip < 0.0
    kinetic = 0.5 * after[1] @ after[1] + 0.5 * 0.4 * 0.01 * spin[1] @ spin[1]
    assert kinetic > 0.5 * before[1] @ before[1]
    limited, _, _ = oblique(70.0, 1.0, 0.5)
    _, _, before, _, after, spin = limited.impacts[0]
    assert 0.5 * after[1] @ after[1] + 0.5 * 0.4 * 0.01 * spin[1] @ spin[1] < 0.5 * before[1] @ before[1]
