"""Eq. 9: the impulse magnitude, with both bodies' masses and turning terms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.rigid.contact_law import collision_impulse, turning_term
from avatarsim.scene.shape import Box
from tests.rigid.upper_world import World, ball, hand, slab, thing

NO_GRAVITY = (0.0, 0.0, 0.0)
vectors = st.tuples(*[st.floats(-1.0, 1.0)] * 3)


@given(
    st.floats(0.0, 1.0), st.floats(0.1, 10.0), st.floats(0.1, 10.0), vectors, vectors, vectors, vectors, vectors, vectors
)
def test_reverses_the_normal_velocity_of_any_two_bodies(
    e: float, ma: float, mb: float, ra: tuple[float, float, float], rb: tuple[float, float, float],
    va: tuple[float, float, float], vb: tuple[float, float, float], wa: tuple[float, float, float],
    wb: tuple[float, float, float],
) -> None:
    """Applied by Newton and Euler with full matrices, j makes v_n exactly -e times its value before: eq. 8."""
    n = np.array([1.0, 2.0, -2.0]) / 3.0
    ia, ib = np.diag([1.0, 2.0, 2.5]), np.array([[2.0, 0.3, 0.0], [0.3, 1.0, 0.1], [0.0, 0.1, 2.2]])
    inverse_a, inverse_b = np.linalg.inv(ia), np.linalg.inv(ib)

    def v_n(va: np.ndarray, wa: np.ndarray, vb: np.ndarray, wb: np.ndarray) -> float:
        return float(n @ (va + np.cross(wa, ra) - vb - np.cross(wb, rb)))

    before = v_n(np.array(va), np.array(wa), np.array(vb), np.array(wb))
    terms = [turning_term((tuple(i[0]), tuple(i[1]), tuple(i[2])), r, tuple(n)) for i, r in ((inverse_a, ra), (inverse_b, rb))]
    j = collision_impulse(e, before, 1.0 / ma, 1.0 / mb, *terms)
    after = v_n(
        np.array(va) + j * n / ma, np.array(wa) + inverse_a @ np.cross(ra, j * n),
        np.array(vb) - j * n / mb, np.array(wb) - inverse_b @ np.cross(rb, j * n),
    )
    assert after == pytest.approx(-e * before, abs=1e-12)


@pytest.mark.parametrize("ratio", [1.0, 10.0, 1e3, 1e6])
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_two_spheres_of_any_mass_ratio(ratio: float, e: float) -> None:
    """v1' = (m1 - e m2) v / M, v2' = (1 + e) m1 v / M."""
    bodies = [
        ball("one", (0.0, 0.0, 0.0), mass=ratio, velocity=(1.0, 0.0, 0.0)), ball("two", (0.5, 0.0, 0.0), mass=1.0),
    ]
    world = World(bodies, e, gravity=NO_GRAVITY)
    world.run(0.5)
    total = ratio + 1.0
    assert world.velocities.linear[0, 0] == pytest.approx((ratio - e) / total, abs=1e-14)
    assert world.velocities.linear[1, 0] == pytest.approx((1.0 + e) * ratio / total, abs=1e-14)


def test_a_rod_hit_off_its_centre() -> None:
    """A small ball hits a resting rod at distance d from its middle: j, v' and w' in closed form."""
    d, e, m_rod, m_ball = 0.35, 0.6, 2.0, 0.5
    rod = thing("rod", Box((1.0, 0.1, 0.1)), (0.0, 0.0, 0.0), m_rod)
    bullet = ball("ball", (d, 0.3, 0.0), 0.02, m_ball, velocity=(0.0, -2.0, 0.0))
    world = World([rod, bullet], e, gravity=NO_GRAVITY)
    while not world.impacts:
        assert world.frame() == 0
    _, _, _, _, after, spin = world.impacts[0]
    inertia = world.dynamics.inertia[0][2, 2]
    j = (1.0 + e) * 2.0 / (1.0 / m_rod + 1.0 / m_ball + d * d / inertia)
    assert after[0, 1] == pytest.approx(-j / m_rod, rel=1e-7)
    assert after[1, 1] == pytest.approx(-2.0 + j / m_ball, rel=1e-7)
    assert spin[0, 2] == pytest.approx(-j * d / inertia, rel=1e-6)


def test_superball() -> None:
    """A light ball on a heavy one, both falling: it leaves at (3M - m)/(M + m) times their speed."""
    small, big = 0.01, 1.0
    world = World(
        [slab(), ball("big", (0.0, 0.0, 0.5), 0.1, big), ball("small", (0.0, 0.0, 0.63 + 1e-6), 0.03, small)], 1.0
    )
    while not any(set(pair) == {1, 2} for _, pair, *_ in world.impacts):
        assert world.frame() == 0
    speed = -world.impacts[0][2][1, 2]
    after = next(i for i in world.impacts if set(i[1]) == {1, 2})[4]
    assert after[2, 2] / speed == pytest.approx((3.0 * big - small) / (big + small), rel=1e-5)


def test_cradle() -> None:
    """Five balls a millimetre apart: the first one's speed arrives at the last one."""
    bodies = [ball(str(i), (0.101 * i, 0.0, 0.0), 0.05) for i in range(1, 5)]
    first = ball("0", (-0.3, 0.0, 0.0), 0.05, velocity=(1.0, 0.0, 0.0))
    world = World([first, *bodies], 1.0, gravity=NO_GRAVITY)
    world.run(1.0)
    np.testing.assert_allclose(world.velocities.linear[:, 0], [0.0, 0.0, 0.0, 0.0, 1.0], atol=1e-12)


def test_a_driven_body_answers_with_its_coupled_mass() -> None:
    """It gets the impulse -j n, reported to the caller, and does not move within the frame."""
    paddle = hand(mass=2.0)
    world = World([ball("ball", (0.0, 0.0, 0.5), mass=0.5, velocity=(0.0, 0.0, -4.0))], 0.5, gravity=NO_GRAVITY, avatars=[paddle])
    where = world.poses.position[1].copy()
    world.velocities.linear[1] = (0.0, 0.0, 1.0)
    while not world.impacts:
        world.velocities.linear[1] = (0.0, 0.0, 1.0)
        assert world.frame() == 0
    j = 1.5 * 5.0 / (1.0 / 0.5 + 1.0 / 2.0)
    np.testing.assert_allclose(world.memory.received[1], [0.0, 0.0, -j], atol=1e-12)
    assert world.velocities.linear[0, 2] == pytest.approx(-4.0 + j / 0.5)
    np.testing.assert_array_equal(world.poses.position[1], where)
