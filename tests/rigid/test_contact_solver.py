"""The contact solver against brute force, its own conditions, and the queue's laws."""

import numpy as np
import pytest

from avatarsim.rigid.contacts import Masses, add_contact, axis, make_contacts, velocity_at, weigh
from avatarsim.rigid.solver import PATIENCE, STALE_BELOW, WANDERS, solve_contacts, sweeps, unsolved
from avatarsim.tolerances import ROUGH

ROOM = 16


def scene(rng: np.random.Generator, points: int, friction: float):
    """Return a block with random contacts under it against the world, thrown at random."""
    contacts = make_contacts(ROOM)
    masses = Masses(np.array([0.0, 0.7]), np.stack([np.zeros((3, 3)), np.diag([3.0, 5.0, 9.0])]))
    for _ in range(points):
        arm = np.array([rng.uniform(-0.3, 0.3), rng.uniform(-0.2, 0.2), -0.1])
        n = np.array([0.2 * rng.normal(), 0.2 * rng.normal(), 1.0])
        assert add_contact(contacts, 1, 0, 0, tuple(n / np.linalg.norm(n)), tuple(arm), tuple(arm), 0.0)
        contacts.friction[contacts.used[0] - 1] = friction
    weigh(contacts, masses)
    linear, angular = np.zeros((2, 3)), np.zeros((2, 3))
    linear[1], angular[1] = rng.normal(size=3) - [0.0, 0.0, 2.0], rng.normal(size=3)
    return contacts, masses, linear, angular


def solve(contacts, masses, linear, angular) -> float:
    """Solve all contacts to 1e-12 m/s."""
    memory = np.zeros((ROOM, 3)), np.zeros((ROOM, 3))
    return solve_contacts(contacts, masses, 0, int(contacts.used[0]), linear, angular, 1e-12, 25, 5000, *memory)


@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("points", [1, 2, 4, 8])
def test_solution_obeys_every_law(points: int, friction: float) -> None:
    """Pushes only, no approach left, no push where there is separation, friction in its disc and against the slip."""
    rng = np.random.default_rng(points)
    for _ in range(10):
        contacts, masses, linear, angular = scene(rng, points, friction)
        assert solve(contacts, masses, linear, angular) <= 1e-12
        assert unsolved(contacts, 0, points, linear, angular) < 1e-10
        for k in range(points):
            u = np.array([np.dot(axis(contacts, k, i), velocity_at(contacts, k, linear, angular)) for i in range(3)])
            p = contacts.impulse[k]
            assert p[0] >= 0.0 and u[0] >= -1e-10 and abs(p[0] * u[0]) < 1e-9
            rub, slip = np.linalg.norm(p[1:]), np.linalg.norm(u[1:])
            assert rub <= friction * p[0] + 1e-12
            if slip > 1e-6 and p[0] > 1e-9:
                np.testing.assert_allclose(p[1:], -friction * p[0] * u[1:] / slip, atol=1e-7)


@pytest.mark.parametrize("cap", [1, 2, 3, 5])
def test_a_solve_cut_short_still_pushes_and_keeps_its_discs(cap: int) -> None:
    rng = np.random.default_rng(cap)
    for _ in range(20):
        contacts, masses, linear, angular = scene(rng, 8, 0.4)
        memory = np.zeros((ROOM, 3)), np.zeros((ROOM, 3))
        sweeps(contacts, masses, 0, 8, linear, angular, 1e-12, cap, True, *memory)
        push, rub = contacts.impulse[:8, 0], np.linalg.norm(contacts.impulse[:8, 1:], axis=1)
        assert (push >= 0.0).all() and (rub <= 0.4 * push + 1e-12).all()


def test_frictionless_solution_is_the_least_kinetic_change() -> None:
    """The plain twin: Gauss's principle as a quadratic programme, by scipy."""
    from scipy.optimize import minimize

    rng = np.random.default_rng(9)
    contacts, masses, linear, angular = scene(rng, 3, 0.0)
    start = np.concatenate([linear[1], angular[1]])
    weight = np.concatenate([np.full(3, 1.0 / 0.7), 1.0 / np.array([3.0, 5.0, 9.0])])
    rows = [np.concatenate([contacts.frame[k, 0], np.cross(contacts.arm_a[k], contacts.frame[k, 0])]) for k in range(3)]
    solve(contacts, masses, linear, angular)
    best = minimize(
        lambda x: 0.5 * np.sum(weight * (x - start) ** 2), start, method="SLSQP",
        constraints=[{"type": "ineq", "fun": lambda x, r=r: r @ x} for r in rows], options={"ftol": 1e-15, "maxiter": 500},
    )
    np.testing.assert_allclose(np.concatenate([linear[1], angular[1]]), best.x, atol=1e-6)


def test_no_room_is_reported() -> None:
    contacts = make_contacts(1)
    point = (0.0, 0.0, 0.0)
    assert add_contact(contacts, 0, 1, 0, (0.0, 0.0, 1.0), point, point, 0.0)
    assert not add_contact(contacts, 0, 1, 0, (0.0, 0.0, 1.0), point, point, 0.0)


def wandering(cap: int) -> tuple[float, np.ndarray, np.ndarray]:
    """A plate that falls on its four corners, of which rounding requires impossible velocities: (residual, impulses, v)."""
    contacts = make_contacts(4)
    for x, y in ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)):
        assert add_contact(contacts, 0, 1, 0, (0.0, 0.0, 1.0), (x, y, 0.0), (x, y, 0.0), 0.0)
    masses = Masses(np.array([1.0, 0.0]), np.array([3.0 * np.eye(3), np.zeros((3, 3))]))
    weigh(contacts, masses)
    contacts.target[:4] = (0.0, 1e-6, 0.0, 1e-6)
    linear, angular = np.array([[0.0, 0.0, -0.4], [0.0, 0.0, 0.0]]), np.zeros((2, 3))
    worst, _ = sweeps(contacts, masses, 0, 4, linear, angular, 1e-12, cap, False, np.zeros((4, 3)), np.zeros((4, 3)))
    return worst, contacts.impulse[:4, 0].copy(), linear[0]


def test_a_load_that_wanders_between_corners_takes_few_sweeps() -> None:
    """Sweeping on would move it for ever, while the velocities stay as they are: more sweeps allowed are not spent."""
    worst, impulses, velocity = wandering(2 * PATIENCE)
    np.testing.assert_array_equal(wandering(40 * PATIENCE)[1], impulses)
    np.testing.assert_array_equal(wandering(10 * WANDERS)[1], impulses)
    assert 1e-12 < worst < 2e-6
    np.testing.assert_allclose(velocity, 0.0, atol=2e-6)
    assert impulses.sum() == pytest.approx(0.4, rel=1e-5)


def test_bodies_in_motion_do_not_wait_for_a_wandering_load() -> None:
    """Two corners have to rise by 10 micrometres a second more than the others: below STALE_BELOW it ends after STALE sweeps."""
    contacts, left = make_contacts(5), []
    for x, y in ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (0.0, 0.0)):
        assert add_contact(contacts, 0, 1, 0, (0.0, 0.0, 1.0), (x, y, 0.0), (x, y, 0.0), 0.0)
    masses = Masses(np.array([1.0, 0.0]), np.array([3.0 * np.eye(3), np.zeros((3, 3))]))
    weigh(contacts, masses)
    contacts.target[:5] = (0.0, 1e-5, 0.0, 1e-5, 0.0)
    for cap in (100, 10000):
        contacts.impulse[:] = 0.0
        contacts.visits[0] = 0
        linear, angular = np.array([[0.0, 0.0, -40.0], [0.0, 0.0, 0.0]]), np.zeros((2, 3))
        worst, ended = sweeps(contacts, masses, 0, 5, linear, angular, ROUGH, cap, False, np.zeros((5, 3)), np.zeros((5, 3)))
        assert ended and worst < STALE_BELOW
        np.testing.assert_allclose(linear[0], 0.0, atol=STALE_BELOW)
        left.append(contacts.impulse[:5, 0].copy())
    assert contacts.visits[0] < 10 * 100
    np.testing.assert_array_equal(left[0], left[1])
