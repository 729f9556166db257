"""Contacts of balls taken four at a time: against the Python of each four to the bit, and against one contact after the other."""

from math import inf

import numpy as np
import pytest

from avatarsim.impact.contact_solver import change
from avatarsim.impact.contacts import DRIVEN_A, LANE, MOTION, ROW, add_contact, make_contacts, weigh
from avatarsim.impact.fours import CONTACT, READ, ROWS_OF_FOUR, WRITTEN, lay_out_fours, take_fours
from avatarsim.impact.masses import Masses
from avatarsim.impact.solver_rows import LANES
from avatarsim.impact.visit_fours import (
    begin_four,
    go_on_four,
    go_on_fours,
    keep_four,
    visit_four,
    visit_fours,
    way_of_four,
)
from avatarsim.kernel import kernel
from tests.impact.one_by_one import one_by_one

pytestmark = pytest.mark.nojit
BODIES, POINTS = 9, 20


def heap(seed: int):
    """Contacts at random between balls, of which the first stands, with impulses as sweeps leave them; some take no part."""
    rng = np.random.default_rng(seed)
    contacts, inertia = make_contacts(4 * POINTS, 1.0, BODIES), np.zeros((BODIES, 3, 3))
    radius = rng.uniform(0.5, 1.5, BODIES)
    inertia[1:] = np.eye(3) * rng.uniform(0.3, 3.0, (BODIES - 1, 1, 1))
    masses = Masses(np.array([0.0, *rng.uniform(0.1, 3.0, BODIES - 1)]), inertia)
    for k in range(POINTS):
        a, b = (int(x) for x in rng.choice(BODIES, 2, replace=False))
        n = rng.normal(size=3)
        n /= np.linalg.norm(n)
        assert add_contact(contacts, a, b, 0, tuple(n), tuple(-radius[a] * n), tuple(radius[b] * n), 0.0)
        contacts.friction[k] = rng.choice([0.0, 0.3, 1.0])
        contacts.slide[k] = 0.1 * rng.normal(size=2)
        contacts.impulse[k, 0] = rng.choice([0.0, 1.0])
        contacts.impulse[k, 1:] = 0.2 * contacts.impulse[k, 0] * contacts.friction[k] * rng.normal(size=2)
    weigh(contacts, masses)
    contacts.target[:POINTS] = rng.choice([-inf, 0.0, 0.2], POINTS)
    linear, angular = rng.normal(size=(2, BODIES, 3))
    linear[0], angular[0] = 0.0, 0.0
    return contacts, masses, linear, angular


@pytest.mark.boundscheck
@pytest.mark.parametrize("grip", [False, True])
@pytest.mark.parametrize("seed", range(10))
def test_two_double_sweeps_are_what_contacts_want_one_by_one(seed: int, grip: bool) -> None:
    contacts, masses, linear, angular = heap(seed)
    twin, _, v, w = heap(seed)
    fours = lay_out_fours(contacts, masses, 0, POINTS, linear, angular)
    order = [int(k) for k in contacts.lanes[: LANES * fours, CONTACT] if k >= 0]
    assert sorted(order) == [k for k in range(POINTS) if contacts.target[k] != -inf] and order
    direction = np.zeros((POINTS, 3))
    for beta in (0.0, 0.5):
        start = twin.impulse[:POINTS].copy()
        for back in (False, True):
            worst, square = visit_fours(contacts, fours, back, grip)
            found = one_by_one(twin, masses, order[::-1] if back else order, grip, v, w)
            np.testing.assert_allclose(worst, found, rtol=1e-9, atol=1e-14)
        way = twin.impulse[:POINTS] - start
        np.testing.assert_allclose(square, (way[order] ** 2).sum(axis=1) @ twin.ease[order, 0], rtol=1e-9, atol=1e-25)
        go_on_fours(contacts, fours, beta, grip)
        direction = way + beta * direction
        for k in order:
            change(twin, masses, k, tuple(direction[k] - way[k]), v, w)
    take_fours(contacts, fours, linear, angular)
    np.testing.assert_allclose(contacts.impulse[:POINTS], twin.impulse[:POINTS], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(linear, v, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(angular, w, rtol=1e-9, atol=1e-12)


@pytest.mark.boundscheck
@pytest.mark.parametrize("seed", range(10))
def test_no_ball_is_twice_in_a_four(seed: int) -> None:
    contacts, masses, linear, angular = heap(seed)
    fours = lay_out_fours(contacts, masses, 0, POINTS, linear, angular)
    lanes, bodies = contacts.lanes[: LANES * fours].reshape(fours, LANES, LANE), len(contacts.worn)
    for four in lanes:
        written, read = four[:, WRITTEN : WRITTEN + 2], four[:, READ : READ + 2]
        moved = written[written < bodies]
        assert len(set(moved)) == len(moved) and 0 not in read and 0 not in moved
        assert four[0, CONTACT] >= 0
        there = four[:, CONTACT][four[:, CONTACT] >= 0]
        assert len(set(contacts.friction[there] > 0.0)) == 1


def spoiled_by_a_driven_body(contacts, masses, linear, angular) -> None:
    contacts.driven[int(np.argmax(contacts.target[:POINTS] > -inf))] = DRIVEN_A


def spoiled_by_what_moves_though_nothing_pushes_it(contacts, masses, linear, angular) -> None:
    contacts.target[:POINTS] = 0.0
    linear[0] = 1.0


def spoiled_by_an_arm_that_leans(contacts, masses, linear, angular) -> None:
    contacts.target[:POINTS] = 0.0
    contacts.arm_a[:, 0] += 0.1
    weigh(contacts, masses)


def spoiled_by_what_turns_unevenly(contacts, masses, linear, angular) -> None:
    contacts.target[:POINTS] = 0.0
    masses.inverse_inertia[1:, 2, 2] *= 1.1


def spoiled_by_being_few(contacts, masses, linear, angular) -> None:
    contacts.used[0] = 5


@pytest.mark.boundscheck
@pytest.mark.parametrize("spoil", [
    spoiled_by_a_driven_body, spoiled_by_what_moves_though_nothing_pushes_it, spoiled_by_an_arm_that_leans,
    spoiled_by_what_turns_unevenly, spoiled_by_being_few,
])
def test_others_are_not_laid_out(spoil) -> None:
    contacts, masses, linear, angular = heap(3)
    spoil(contacts, masses, linear, angular)
    assert lay_out_fours(contacts, masses, 0, int(contacts.used[0]), linear, angular) == 0


@kernel
def compiled_visit(rows: np.ndarray, lanes: np.ndarray, g: int, motion: np.ndarray, rough: bool) -> float:
    """As kernels call it; under NUMBA_DISABLE_JIT the Python itself."""
    return visit_four(rows, lanes, g, motion, rough)


@kernel
def compiled_go_on(rows: np.ndarray, lanes: np.ndarray, g: int, motion: np.ndarray, rough: bool, beta: float) -> None:
    go_on_four(rows, lanes, g, motion, rough, beta)


@kernel
def compiled_keep(rows: np.ndarray, g: int) -> None:
    keep_four(rows, g)


@kernel
def compiled_begin(rows: np.ndarray, g: int) -> None:
    begin_four(rows, g)


@kernel
def compiled_way(rows: np.ndarray, g: int) -> float:
    return way_of_four(rows, g)


@pytest.mark.parametrize("rough", [False, True])
@pytest.mark.parametrize("seed", range(20))
def test_vector_code_is_the_python_to_the_bit(seed: int, rough: bool) -> None:
    rng = np.random.default_rng(seed)
    rows, motion, g = rng.normal(size=(2 * ROWS_OF_FOUR, ROW)), rng.normal(size=(2 * LANES, MOTION)), seed % 2
    motion[:, LANES - 1 :: LANES] = 0.0
    lanes = np.zeros((2 * LANES, LANE), np.int64)
    for four in (0, 1):
        who = rng.permutation(2 * LANES).reshape(LANES, 2)
        lanes[LANES * four : LANES * (four + 1), READ : READ + 2] = who
        lanes[LANES * four : LANES * (four + 1), WRITTEN : WRITTEN + 2] = who
    twin, twin_motion = rows.copy(), motion.copy()
    for _ in range(3):
        compiled_keep(rows, g)
        keep_four(twin, g)
        assert compiled_visit(rows, lanes, g, motion, rough) == visit_four(twin, lanes, g, twin_motion, rough)
        assert compiled_way(rows, g) == way_of_four(twin, g)
        compiled_go_on(rows, lanes, g, motion, rough, 0.3)
        go_on_four(twin, lanes, g, twin_motion, rough, 0.3)
        np.testing.assert_array_equal(rows, twin)
        np.testing.assert_array_equal(motion, twin_motion)
    compiled_begin(rows, g)
    begin_four(twin, g)
    np.testing.assert_array_equal(rows, twin)
