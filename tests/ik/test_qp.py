"""The QP of a step, and its multipliers by the active set, against non-negative least squares."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import minimize, nnls

from avatarsim.ik.objective import model
from avatarsim.ik.qp import finish, solve_qp
from avatarsim.ik.state import ACTIVE_CAP, MOST_PRESSED, ConstraintRows, RowKind
from avatarsim.model.skeleton import FREE
from tests.ik.solvers import TREES, Solver, apart, metric_of, solver_of

Array = NDArray[np.float64]


def least_distance(rows: Array, bound: Array) -> tuple[Array, Array]:
    """Return the shortest y with rows @ y >= bound, and the multipliers with which y = rows^T multipliers."""
    system = np.vstack([rows.T, bound])
    wanted = np.zeros(len(system))
    wanted[-1] = 1.0
    found, _ = nnls(system, wanted)
    left = system @ found - wanted
    assert left[-1] < -1e-9, "the conditions contradict each other"
    return left[:-1] / -left[-1], found / -left[-1]


def nearest_step(metric: Array, step: Array, rows: Array, bound: Array) -> Array:
    """Return the x nearest to `step` in `metric` (n, n) with rows @ x >= bound."""
    root = np.linalg.cholesky(metric).T
    moved = np.linalg.solve(root.T, rows.T).T
    y, _ = least_distance(moved, bound - rows @ step)
    return np.asarray(step + np.linalg.solve(root, y))


pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
TOLERANCE = 1e-10


def asked(seed: int, count: int, by: float = 0.1) -> tuple[Solver, Array, Array]:
    """Return three trees as one island, modelled, and random contact rows of one or two of them that a random step obeys."""
    found, rng = apart(seed, by), np.random.default_rng(seed)
    found.solve_for_all()
    for avatar in range(found.count):
        model(found.rig, avatar, found.state, found.world.poses, found.working.objective)
    r, spans = found.working.rows, list(pairwise(found.avatars.first_dof.tolist()))
    r.used[0], r.ready[0] = count, 0
    obeying = rng.normal(0.0, 0.1, len(found.avatars.joint_of))
    r.jacobian[:count], r.multiplier[:count], r.kind[:count] = 0.0, 0.0, RowKind.CONTACT
    for k in range(count):
        one, other = sorted(rng.choice(found.count, 2, replace=False).tolist())
        r.owner[k] = (one, other if rng.random() < 0.4 else -1)
        for avatar in r.owner[k][r.owner[k] >= 0]:
            low, high = spans[avatar]
            r.jacobian[k, low:high] = rng.normal(size=high - low)
        r.pair[k] = (k, k)
    r.bound[:count] = r.jacobian[:count] @ obeying - rng.choice([0.0, 0.05], count)
    return found, r.jacobian[:count].copy(), r.bound[:count].copy()


def solved(found: Solver) -> Array:
    """Return the step of all avatars."""
    solve_qp(found.rig, 0, found.count, TOLERANCE, found.state, found.working)
    return found.working.step.copy()


def cost(found: Solver, step: Array) -> float:
    """Return the objective of the QP."""
    off = step - found.working.objective.newton
    return float(0.5 * off @ metric_of(found) @ off)


def groups(found: Solver) -> list[tuple[slice, str]]:
    """Return the degrees that a budget bounds together, and which of an avatar's budgets."""
    skel, places = found.world.skeleton, []
    for link, kind in enumerate(skel.kind):
        d, last = int(skel.first_dof[link]), int(skel.first_dof[link + 1])
        if kind == FREE:
            places.append((slice(d, d + 3), "move"))
            d += 3
        if last > d:
            places.append((slice(d, last), "turn"))
    return places


@given(st.integers(0, 10**6), st.integers(1, 9))
def test_contacts_of_and_between_avatars(seed: int, count: int) -> None:
    found, rows, bound = asked(seed, count)
    wanted = nearest_step(metric_of(found), found.working.objective.newton, rows, bound)
    step = solved(found)
    assert (rows @ step >= bound - 1e-7).all()
    assert step == pytest.approx(wanted, abs=1e-6)


@given(st.integers(0, 10**6))
def test_bounds_that_are_violated_join(seed: int) -> None:
    """Hinges are held to less than the free step moves them."""
    found, rows, bound = asked(seed, 3)
    rng = np.random.default_rng(seed + 1)
    at = found.world.hinges
    found.working.low[at], found.working.high[at] = -rng.uniform(0.0, 0.03, len(at)), rng.uniform(0.0, 0.03, len(at))
    unit = np.eye(len(found.avatars.joint_of))[at]
    wanted = nearest_step(
        metric_of(found), found.working.objective.newton, np.vstack([rows, unit, -unit]),
        np.concatenate([bound, found.working.low[at], -found.working.high[at]]),
    )
    step = solved(found)
    assert (step >= found.working.low).all() and (step <= found.working.high).all()
    assert (rows @ step >= bound - 1e-6).all() and step == pytest.approx(wanted, abs=1e-5)


def within_budgets(found: Solver, left: float) -> Array:
    """Return the nearest step of which no group goes farther than `left`, by scipy."""
    metric, wish = metric_of(found), found.working.objective.newton
    masks = np.zeros((len(groups(found)), len(wish)))
    for mask, (at, _) in zip(masks, groups(found), strict=True):
        mask[at] = 1.0
    balls = {"type": "ineq", "fun": lambda x: left**2 - masks @ x**2, "jac": lambda x: -2.0 * masks * x}
    got = minimize(
        lambda x: 0.5 * (x - wish) @ metric @ (x - wish), np.zeros(len(wish)), jac=lambda x: metric @ (x - wish), method="SLSQP",
        constraints=balls, options={"ftol": 1e-12, "maxiter": 300},
    )
    assert got.success
    return np.asarray(got.x)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("left", [0.02, 0.15])
def test_a_step_within_budgets_is_as_good_as_scipys(seed: int, left: float) -> None:
    """And better, where it uses its allowance beyond them."""
    found, _, _ = asked(seed, 0)
    found.state.budget.turn[:], found.state.budget.move[:], found.state.budget.slack[:] = left, left, 0.15 * left
    none, best = cost(found, np.zeros(len(found.avatars.joint_of))), cost(found, within_budgets(found, left))
    assert cost(found, solved(found)) - best <= 1e-6 * (none - best)


@given(st.integers(0, 10**6), st.floats(0.005, 0.2))
def test_budgets_are_kept_in_every_direction_and_cost_no_more(seed: int, left: float) -> None:
    """Together with contacts: no joint or root goes farther than its budget and its slack, and the step costs no more than
    any that keeps the budgets themselves, of which scaled copies of the solution without budgets are some."""
    found, rows, bound = asked(seed, 2)
    bound[:] = np.minimum(bound, 0.0)
    found.working.rows.bound[:2] = bound
    free = nearest_step(metric_of(found), found.working.objective.newton, rows, bound)
    found.state.budget.turn[:], found.state.budget.move[:], found.state.budget.slack[:] = left, left, 0.1 * left
    step = solved(found)
    norms = [float(np.linalg.norm(step[place])) for place, _ in groups(found)]
    assert max(norms) <= 1.1 * left * (1.0 + 1e-9)
    longest = max(float(np.linalg.norm(free[place])) for place, _ in groups(found))
    assert cost(found, step) <= cost(found, free * min(1.0, left / longest)) + 1e-9
    if longest <= left:
        assert step == pytest.approx(free, abs=1e-6)


def test_what_was_spent_of_a_budget_is_not_there_any_more() -> None:
    found, _, _ = asked(3, 0)
    budget, skel = found.state.budget, found.world.skeleton
    budget.turn[:], budget.move[:], budget.turned[:], budget.moved[:] = 0.02, 0.02, 0.015, 0.03
    step = solved(found)
    for link in range(len(skel.kind)):
        mine = step[skel.first_dof[link] : skel.first_dof[link + 1]]
        root, joint = (mine[:3], mine[3:]) if skel.kind[link] == FREE else (mine[:0], mine)
        assert (root == 0.0).all() and np.linalg.norm(joint) <= 0.005 + 1e-8


def test_without_rows_it_is_the_step_of_the_model() -> None:
    found, _, _ = asked(5, 0)
    assert (solved(found) == found.working.objective.newton).all()


def test_the_same_row_many_times_is_shared_and_solved() -> None:
    """As the corners of a foot on a floor are."""
    found, rows, bound = asked(7, 1)
    r = found.working.rows
    bound[0] = float(rows[0] @ found.working.objective.newton) + 0.05
    for k in range(12):
        r.jacobian[k], r.bound[k], r.owner[k], r.kind[k], r.multiplier[k] = rows[0], bound[0], r.owner[0], r.kind[0], 0.0
    r.used[0] = 12
    wanted = nearest_step(metric_of(found), found.working.objective.newton, rows, bound)
    assert solved(found) == pytest.approx(wanted, abs=1e-5)


def test_contradicting_rows_end_in_finite_numbers() -> None:
    found, rows, _ = asked(8, 2)
    r = found.working.rows
    r.owner[1], r.jacobian[0], r.jacobian[1], r.bound[:2] = r.owner[0], rows[0], -rows[0], 1.0
    found.working.low[:], found.working.high[:] = -0.5, 0.5
    step = solved(found)
    assert np.isfinite(step).all() and (np.abs(step) <= 0.5).all()
    assert (r.multiplier[: r.used[0]] <= MOST_PRESSED).all()


@pytest.mark.parametrize("where", ["newton", "jacobian", "bound", "factor"])
def test_a_nan_leads_to_a_nan_or_to_a_step_inside_its_bounds(where: str) -> None:
    """A nan is then refused by the certificate."""
    found, _, _ = asked(9, 2)
    found.working.low[:], found.working.high[:] = -0.3, 0.3
    {
        "newton": found.working.objective.newton, "jacobian": found.working.rows.jacobian[0],
        "bound": found.working.rows.bound, "factor": found.working.objective.factor[3],
    }[where][0] = np.nan
    step = solved(found)
    assert (np.isnan(step) | (np.abs(step) <= 0.3)).all()


def test_a_full_table_takes_no_more_rows() -> None:
    found, _, _ = asked(4, 1)
    r, m = found.working.rows, len(found.working.rows.bound)
    r.owner[:], r.jacobian[:], r.bound[:], r.kind[:] = (0, -1), 0.0, -1.0, RowKind.CONTACT
    r.jacobian[:, : found.avatars.first_dof[1]] = np.random.default_rng(0).normal(size=(m, int(found.avatars.first_dof[1])))
    r.used[0] = m
    found.working.low[:], found.working.high[:] = -1e-3, 1e-3
    step = solved(found)
    assert r.used[0] == m and (np.abs(step) <= 1e-3).all()


ROWS = solver_of(TREES).working.rows
FINISHED = 1e-9


def rows_of(rows: np.ndarray, bound: np.ndarray, multiplier: np.ndarray) -> ConstraintRows:
    """Return rows of a least-distance problem, as sweeps that came to those multipliers leave them."""
    gram, m = rows @ rows.T, len(bound)
    ROWS.used[0], ROWS.gram[:m, :m], ROWS.multiplier[:m] = m, gram, multiplier
    ROWS.residual[:m] = gram @ multiplier - bound
    return ROWS


@given(st.integers(0, 10**6), st.integers(1, 12), st.booleans())
def test_from_anywhere_it_comes_to_the_least_distance(seed: int, m: int, is_warm: bool) -> None:
    rng = np.random.default_rng(seed)
    rows, least = rng.normal(size=(m, 15)), rng.normal(size=15)
    bound = rows @ least - rng.choice([0.0, 0.5], m)
    begin = np.where(rng.random(m) < 0.5, rng.uniform(0.0, 1.0, m), 0.0) if is_warm else np.zeros(m)
    found = rows_of(rows, bound, begin)
    wanted, _ = least_distance(rows, bound)
    assert finish(FINISHED, found)
    pressing = found.multiplier[:m]
    assert (pressing >= 0.0).all() and rows.T @ pressing == pytest.approx(wanted, abs=1e-6)
    assert found.residual[:m] == pytest.approx(rows @ wanted - bound, abs=1e-6), "residuals are kept up to date"


def test_infeasible_rows_leave_the_multipliers_as_they_were() -> None:
    rows = np.array([[1.0, 0.0], [-1.0, 0.0]])
    begin = np.array([0.25, 0.0])
    found = rows_of(rows, np.array([1.0, 1.0]), begin)
    assert not finish(FINISHED, found)
    assert (found.multiplier[:2] == begin).all() and (found.multiplier[:2] < MOST_PRESSED).all()


def test_too_many_active_rows_are_left_to_the_sweeps() -> None:
    m = ACTIVE_CAP + 1
    begin = np.full(m, 0.5)
    found = rows_of(np.eye(m), np.ones(m), begin)
    assert not finish(FINISHED, found) and (found.multiplier[:m] == begin).all()
    found = rows_of(np.eye(m - 1), np.ones(m - 1), begin[1:])
    assert finish(FINISHED, found) and found.multiplier[: m - 1] == pytest.approx(1.0, rel=1e-8)
