"""Every closed form against a second derivation: numerical integration, a brute-force sum, or conserved quantities."""

from math import cos, isclose, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from reference import closed_form as exact

G = 9.81


def integrated(rate, start, time, until=None):
    """Return state at `time`, or where `until` is zero, by an eighth-order Runge-Kutta method."""
    if until is not None:
        until.terminal = True
    return solve_ivp(rate, (0.0, time), start, method="DOP853", rtol=1e-12, atol=1e-13, events=until)


def test_free_fall_is_what_integration_gives():
    end = integrated(lambda t, s: [s[1], -G], [2.0, 3.0], 0.7).y[:, -1]
    assert end == pytest.approx([exact.fall_height(2.0, 3.0, G, 0.7), exact.fall_velocity(3.0, G, 0.7)], abs=1e-11)


@pytest.mark.parametrize("mass", [0.1, 0.4, 1.0, 10.0])
@pytest.mark.parametrize("time", [0.001, 0.05, 0.3])
def test_spring_state_is_what_integration_gives(mass, time):
    end = integrated(lambda t, s: [s[1], (-1000.0 * s[0] - 40.0 * s[1]) / mass], [0.2, -1.5], time).y[:, -1]
    assert exact.spring_state(0.2, -1.5, mass, 1000.0, 40.0, time) == pytest.approx(end, abs=1e-9)


@pytest.mark.parametrize(("restitution", "published"), [(0.5, 1.3546), (0.3, 0.8385)])
def test_zeno_end_is_the_sum_of_all_flights(restitution, published):
    flights = [2.0 * restitution**k * exact.impact_speed(1.0, G) / G for k in range(1, 200)]
    assert exact.zeno_time(1.0, restitution, G) == pytest.approx(sqrt(2.0 / G) + sum(flights), rel=1e-12)
    assert exact.zeno_time(1.0, restitution, G) == pytest.approx(published, abs=5e-5)
    assert exact.zeno_time(1.0, 1.0, G) == np.inf


@given(restitution=st.floats(0.0, 1.0), time=st.floats(0.0, 3.0))
def test_bounce_state_agrees_with_walking_from_impact_to_impact(restitution, time):
    clock, up, height = 0.0, 0.0, 1.0
    for _ in range(10_000):
        flight = (up + sqrt(up * up + 2.0 * G * height)) / G
        if flight < 1e-12:
            # flights this short add up to no time: at rest
            up = height = 0.0
            break
        if clock + flight > time:
            break
        clock, up, height = clock + flight, restitution * (G * flight - up), 0.0
    left = time - clock
    want = (height + up * left - G * left * left / 2.0, up - G * left) if up > 0.0 or height > 0.0 else (0.0, 0.0)
    got = exact.bounce_state(1.0, restitution, G, time)
    assert got[0] == pytest.approx(want[0], abs=1e-9)
    assert -1e-12 <= got[0] <= 1.0
    # at an impact the velocity jumps; away from it both walks agree
    if got[0] > 1e-6:
        assert got[1] == pytest.approx(want[1], abs=1e-6)


def test_bounce_state_right_after_each_impact_moves_up():
    for impact in range(1, 12):
        time = exact.bounce_time(1.0, 0.7, G, impact)
        height, velocity = exact.bounce_state(1.0, 0.7, G, time * (1 + 1e-12))
        assert height == pytest.approx(0.0, abs=1e-9)
        assert velocity == pytest.approx(0.7**impact * exact.impact_speed(1.0, G), rel=1e-6)


def test_wall_contact_time_leaves_the_ball_on_the_surface():
    time = exact.wall_contact_time(1.0, 0.01, 0.02, 30.0)
    assert 30.0 * time + 0.01 == pytest.approx(1.0 - 0.01)


@given(
    masses=st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3)),
    speeds=st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
    restitution=st.floats(0, 1),
)
def test_two_spheres_keep_momentum_and_obey_restitution(masses, speeds, restitution):
    (a, b), (u, v) = masses, speeds
    # the two laws as a linear system
    want = np.linalg.solve([[a, b], [-1.0, 1.0]], [a * u + b * v, restitution * (u - v)])
    assert exact.two_spheres(a, b, u, v, restitution) == pytest.approx(want, abs=1e-9)


def test_superball_is_a_floor_bounce_and_then_two_spheres():
    for light in (0.01, 0.3, 1.0):
        after, _ = exact.two_spheres(light, 1.0, -2.0, 2.0, 1.0)
        assert exact.superball_speed(light, 1.0, 2.0) == pytest.approx(after)
    assert exact.superball_speed(0.01, 1.0, 1.0) == pytest.approx(2.960, abs=5e-4)


def test_cradle_is_a_chain_of_two_sphere_impacts():
    speeds = [1.0, 0.0, 0.0, 0.0, 0.0]
    for k in range(4):
        speeds[k], speeds[k + 1] = exact.two_spheres(1.0, 1.0, speeds[k], speeds[k + 1], 1.0)
    assert exact.cradle_velocities(5, 1.0) == pytest.approx(tuple(speeds))


def dripped(approach, tangential, friction, restitution, radius, drops=200_000):
    """Return the oblique bounce of a unit mass, its impulse applied in tiny drops; friction acts against the remaining slip."""
    drop = (1.0 + restitution) * approach / drops
    spin = 0.0
    for k in range(drops):
        slip = tangential - radius * spin
        # the impulse that stops the slip altogether: slip changes by 7/2 of the impulse per unit mass
        push = min(friction * drop, slip / 3.5)
        if push <= 0.0 and k:
            break
        tangential -= push
        spin += 2.5 * push / radius
    return tangential, spin


@pytest.mark.parametrize("friction", [0.05, 0.1, 0.3, 0.8])
@pytest.mark.parametrize("approach", [1.0, 4.0])
def test_oblique_bounce_is_the_limit_of_small_impulses(friction, approach):
    got = exact.oblique_bounce(approach, 3.0, friction, 0.4, 0.1)
    tangential, spin = dripped(approach, 3.0, friction, 0.4, 0.1)
    assert got.normal == pytest.approx(0.4 * approach)
    assert (got.tangential, got.spin) == pytest.approx((tangential, spin), abs=1e-6)
    # sticking means rolling
    assert got.sticks == isclose(got.tangential, got.spin * 0.1, rel_tol=1e-12)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 1.0])
def test_point_impact_solves_newton_euler_and_restitution(restitution):
    rng = np.random.default_rng(3)
    for _ in range(20):
        spread = rng.normal(size=(3, 3))
        inertia, mass = spread @ spread.T + np.eye(3), rng.uniform(0.5, 3.0)
        v, w, r = rng.normal(size=(3, 3))
        n = rng.normal(size=3)
        n /= np.linalg.norm(n)
        n *= -np.sign(n @ (v + np.cross(w, r)))
        # unknowns v', w', j: m (v' - v) = j n; I (w' - w) = j r x n; n . (v' + w' x r) = -e n . (v + w x r)
        system = np.zeros((7, 7))
        system[:3, :3], system[:3, 6] = mass * np.eye(3), -n
        system[3:6, 3:6], system[3:6, 6] = inertia, -np.cross(r, n)
        system[6, :3], system[6, 3:6] = n, np.cross(r, n)
        right = np.concatenate([mass * v, inertia @ w, [-restitution * (n @ (v + np.cross(w, r)))]])
        solved = np.linalg.solve(system, right)
        j, after, spin = exact.point_impact(mass, inertia, v, w, r, n, restitution)
        assert np.concatenate([after, spin, [j]]) == pytest.approx(solved, abs=1e-10)
        if restitution == 1.0:
            assert mass * after @ after + spin @ inertia @ spin == pytest.approx(mass * v @ v + w @ inertia @ w)


def test_a_separating_contact_gets_no_impulse():
    j, v, w = exact.point_impact(1.0, np.eye(3), [0, 0, 1.0], [0, 0, 0], [0.1, 0, -0.1], [0, 0, 1.0], 0.5)
    assert j == 0.0
    assert v.tolist() == [0, 0, 1.0]
    assert w.tolist() == [0, 0, 0]


def test_sliding_body_stops_where_integration_stops_it():
    def stopped(t, s):
        return s[1]

    slide = integrated(lambda t, s: [s[1], -0.5 * G], [0.0, 3.0], 5.0, until=stopped)
    assert slide.t_events[0][0] == pytest.approx(exact.stop_time(3.0, 0.5, G), abs=1e-10)
    assert slide.y_events[0][0][0] == pytest.approx(exact.stop_distance(3.0, 0.5, G), abs=1e-10)
    assert exact.stop_distance(3.0, 0.5, G) == pytest.approx(0.9174, abs=5e-5)


def test_sliding_sphere_rolls_where_integration_says():
    radius, friction = 0.03, 0.2

    def rolls(t, s):
        return s[1] - radius * s[2]

    # torque mu m g r on 2/5 m r^2
    motion = integrated(lambda t, s: [s[1], -friction * G, 2.5 * friction * G / radius], [0.0, 3.0, 0.0], 5.0, until=rolls)
    way, speed, _ = motion.y_events[0][0]
    assert motion.t_events[0][0] == pytest.approx(exact.roll_time(3.0, friction, G), abs=1e-10)
    assert way == pytest.approx(exact.roll_distance(3.0, friction, G), abs=1e-10)
    assert speed == pytest.approx(exact.roll_speed(3.0), abs=1e-10)
    assert (way, motion.t_events[0][0]) == pytest.approx((1.1234, 0.4369), abs=5e-5)


def test_incline_agrees_with_forces_in_world_axes():
    slope, friction = pi / 6, 0.15
    down = np.array([cos(slope), -sin(slope)])
    normal = np.array([sin(slope), cos(slope)])
    weight = np.array([0.0, -G])
    press = -(weight @ normal)
    force = weight + press * normal - friction * press * down
    assert exact.incline_acceleration(slope, friction, G) == pytest.approx(force @ down)
    assert force @ normal == pytest.approx(0.0, abs=1e-12)
    assert exact.incline_acceleration(slope, friction, G) == pytest.approx(3.63064, abs=5e-6)
    assert exact.incline_acceleration(slope, 0.58, G) == 0.0


def test_falling_rod_is_what_its_equation_of_motion_gives():
    length, start = 1.0, 0.1

    def rate(t, s):
        # centre height L/2 cos a: Lagrange's equation for (1/12 + sin^2 a / 4) m L^2 a'' with gravity, frictionless floor
        a, w = s
        pull = 0.5 * length * sin(a) * (G - 0.5 * length * cos(a) * w * w)
        return [w, pull / (length**2 / 12.0 + 0.25 * length**2 * sin(a) ** 2)]

    def down(t, s):
        return s[0] - pi / 2

    w = integrated(rate, [start, 0.0], 5.0, until=down).y_events[0][0][1]
    assert exact.rod_angular_velocity(start, pi / 2, length, G) == pytest.approx(w, abs=1e-9)
    assert w == pytest.approx(5.4114, abs=5e-5)


@pytest.mark.parametrize(("rough", "smooth"), [(0.3, -0.3), (0.1, -0.5), (-0.4, 0.2)])
def test_loads_of_a_sliding_tripod_balance_forces_and_moments(rough, smooth):
    mass, friction, height, wide = 3.0, 0.2, 0.1, 0.4
    feet = np.array([[rough, 0.0, -height], [smooth, wide, -height], [smooth, -wide, -height]])
    up, back = np.array([0.0, 0.0, 1.0]), np.array([-1.0, 0.0, 0.0])
    pushes = [up + friction * back, up, up]
    # moments about x and y vanish (about z friction acts through the middle), and the feet carry the weight
    rows = np.array([np.cross(foot, push) for foot, push in zip(feet, pushes, strict=True)]).T
    loads = np.linalg.solve(np.array([rows[0], rows[1], np.ones(3)]), [0.0, 0.0, mass * G])
    assert loads[0] == pytest.approx(exact.tripod_load(mass, G, rough, smooth, friction, height), rel=1e-12)
    assert (loads > 0.0).all()
