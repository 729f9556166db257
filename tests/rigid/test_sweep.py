"""A sweep of projected Gauss-Seidel against its plain twin, one contact after the other, and its sums against numpy."""

import numpy as np
import pytest

from avatarsim.rigid.contacts import (
    DRIVEN_A,
    DRIVEN_B,
    NOT_DRIVEN,
    Masses,
    add_contact,
    make_contacts,
    weigh_after,
)
from avatarsim.rigid.solver import (
    change,
    conjugate_step,
    gauss_seidel_sweep,
    lay_out,
    take_motion,
    wanted_friction,
    wanted_normal,
)

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
BODIES, POINTS = 4, 12


def heap(seed: int):
    """Return contacts at random between bodies at random, one of them fixed, with impulses as sweeps leave them."""
    rng = np.random.default_rng(seed)
    contacts, inertia = make_contacts(POINTS), np.zeros((BODIES, 3, 3))
    for b in range(1, BODIES):
        half = rng.normal(size=(3, 3))
        inertia[b] = half @ half.T + np.eye(3)
    masses = Masses(np.array([0.0, *rng.uniform(0.1, 3.0, BODIES - 1)]), inertia)
    for k in range(POINTS):
        a, b = rng.choice(BODIES, 2, replace=False)
        n = rng.normal(size=3)
        driven, arms = int(rng.choice([NOT_DRIVEN, DRIVEN_A, DRIVEN_B])), rng.normal(size=(2, 3))
        assert add_contact(contacts, a, b, driven, tuple(n / np.linalg.norm(n)), tuple(arms[0]), tuple(arms[1]), 0.0)
        contacts.friction[k] = rng.choice([0.0, 0.3, 1.0])
        contacts.target[k] = rng.choice([-np.inf, 0.0, 0.2])
        contacts.slide[k] = 0.1 * rng.normal(size=2)
        contacts.drift[k] = 0.0 if driven == NOT_DRIVEN else 0.3 * rng.normal(size=2)
        contacts.impulse[k, 0] = rng.choice([0.0, 1.0])
        contacts.impulse[k, 1:] = 0.2 * contacts.impulse[k, 0] * contacts.friction[k] * rng.normal(size=2)
        contacts.sway_a[k], contacts.sway_b[k] = rng.normal(size=(2, 3))
    contacts.standing[0] = rng.integers(2)
    weigh_after(contacts, masses, 0.01)
    return contacts, masses, rng.normal(size=(BODIES, 3)), rng.normal(size=(BODIES, 3))


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("grip", [False, True])
def test_a_pass_is_what_its_contacts_want_one_by_one(back: bool, grip: bool) -> None:
    for seed in range(40):
        contacts, masses, linear, angular = heap(seed)
        twin, _, v, w = heap(seed)
        before = contacts.impulse.copy()
        kept = before.copy() if back else np.zeros((POINTS, 3))
        lay_out(contacts, masses, 0, POINTS, linear, angular)
        worst, square = gauss_seidel_sweep(contacts, 0, POINTS, back, grip, kept)
        take_motion(contacts, 0, POINTS, linear, angular)
        order = range(POINTS)[::-1] if back else range(POINTS)
        assert worst == pytest.approx(one_by_one(twin, masses, order, grip, v, w), rel=1e-12, abs=1e-12)
        np.testing.assert_array_equal(kept, before)
        for ours, theirs in ((contacts.impulse, twin.impulse), (linear, v), (angular, w)):
            np.testing.assert_allclose(ours, theirs, rtol=1e-11, atol=1e-11)
        moved = ((contacts.impulse - before) ** 2).sum(axis=1) * contacts.inverse_effective_mass[:, 0]
        assert square == pytest.approx(moved[contacts.target != -np.inf].sum() if back else 0.0, rel=1e-12)


def test_all_go_on_along_the_last_way() -> None:
    """Impulses gain beta times the direction, velocities follow, and the direction is then the way since with that."""
    contacts, masses, linear, angular = heap(1)
    twin, _, v, w = heap(1)
    rng = np.random.default_rng(2)
    before, direction = rng.normal(size=(2, POINTS, 3))
    # a contact without friction never went along its tangents
    direction[contacts.friction[:POINTS] == 0.0, 1:] = 0.0
    wanted = contacts.impulse - before + 0.7 * direction
    for k in range(POINTS):
        if twin.target[k] != -np.inf:
            change(twin, masses, k, tuple(0.7 * direction[k]), v, w)
        else:
            wanted[k] = direction[k]
    lay_out(contacts, masses, 0, POINTS, linear, angular)
    conjugate_step(contacts, 0, POINTS, 0.7, before, direction)
    take_motion(contacts, 0, POINTS, linear, angular)
    for ours, theirs in ((contacts.impulse, twin.impulse), (linear, v), (angular, w), (direction, wanted)):
        np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12)


def one_by_one(contacts, masses, order, grip: bool, linear, angular) -> float:
    """Sweep over contacts in that order, normal first, friction if `grip`; returns the largest change of velocity."""
    worst = 0.0
    for k in order:
        if contacts.target[k] == -np.inf:
            continue
        dn = wanted_normal(contacts, k, linear, angular) - contacts.impulse[k, 0]
        change(contacts, masses, k, (dn, 0.0, 0.0), linear, angular)
        worst = max(worst, abs(dn) * contacts.inverse_effective_mass[k, 0])
        if grip and contacts.friction[k] > 0.0:
            x, y = wanted_friction(contacts, k, contacts.impulse[k, 0], linear, angular)
            dx, dy = x - contacts.impulse[k, 1], y - contacts.impulse[k, 2]
            change(contacts, masses, k, (0.0, dx, dy), linear, angular)
            worst = max(worst, (abs(dx) + abs(dy)) * contacts.inverse_effective_mass[k, 1])
    return worst
