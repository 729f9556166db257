"""The dual ascent against a slow solver of the same quadratic program."""

import numpy as np
import pytest
from scipy.optimize import minimize

from avatarsim.posture.nearest_step import MULTIPLIER_CAP, nearest_step
from avatarsim.posture.workspace import COUNT, COUPLED, Goal, Rows, make_memory
from avatarsim.scene.scene import Scene
from avatarsim.world.world import build
from tests.stability.hostile import hinged_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def arrays(nd: int, rng: np.random.Generator) -> tuple[Goal, Rows]:
    """A goal and rows of nd degrees with random wishes and weights, bounds far away."""
    world = build(Scene("s", avatars=(hinged_avatar(),)))
    memory = make_memory(world.geometry, world.skeleton, world.poses)
    r = memory.rows
    goal = memory.goal._replace(
        full=np.zeros(nd), step=rng.normal(size=nd), low=np.full(nd, -50.0), high=np.full(nd, 50.0), trust=np.ones(nd),
        inverse_weight=rng.uniform(0.2, 2.0, nd),
    )
    rows = r._replace(
        jacobian=np.ascontiguousarray(r.jacobian[:, :nd]), weighted=np.ascontiguousarray(r.weighted[:, :nd]), x=np.zeros(nd),
        here=np.zeros(nd),
    )
    return goal, rows


def solve(goal: Goal, rows: Rows, jacobian: np.ndarray, bound: np.ndarray, sweeps: int, tolerance: float) -> tuple[int, int]:
    """Write contact rows and solve; return the rows, bounds included, and the sweeps used."""
    m = len(bound)
    rows.jacobian[:m], rows.bound[:m], rows.multiplier[:m], rows.pair[:m] = jacobian, bound, 0.0, 0
    rows.size[:] = 0
    rows.size[COUNT] = m
    used = nearest_step(goal, rows, sweeps, tolerance)
    return int(rows.size[COUNT]), used


def slow(goal: Goal, jacobian: np.ndarray, bound: np.ndarray, metric: np.ndarray | None = None) -> np.ndarray:
    """The same problem by scipy."""
    weight = np.diag(1.0 / goal.inverse_weight) if metric is None else metric
    found = minimize(
        lambda x: 0.5 * (x - goal.step) @ weight @ (x - goal.step), np.zeros(len(weight)), jac=lambda x: weight @ (x - goal.step),
        method="SLSQP", bounds=list(zip(goal.low, goal.high, strict=True)),
        constraints=[{"type": "ineq", "fun": lambda x: jacobian @ x - bound, "jac": lambda x: jacobian}],
        options={"ftol": 1e-14, "maxiter": 500},
    )
    assert found.success
    return np.asarray(found.x)


@pytest.mark.parametrize("seed", range(6))
def test_a_metric_that_couples_degrees(seed: int) -> None:
    """The metric M = L^T L of `closeness.py` beside the same problem by scipy, bounds included."""
    rng = np.random.default_rng(seed)
    goal, rows = arrays(8, rng)
    factor = np.tril(rng.normal(0.0, 0.2, (8, 8)), -1) + np.diag(rng.uniform(0.7, 2.0, 8))
    measure = goal.closeness._replace(path=np.tile(np.arange(8), (8, 1)), depth=np.arange(8), factor=factor)
    measure.mode[COUPLED] = 1.0
    goal = goal._replace(closeness=measure, low=np.full(8, -0.8), high=np.full(8, 0.8))
    jacobian, bound = rng.normal(size=(3, 8)), rng.uniform(-1.0, 0.0, 3)
    for m in (3, 0):
        solve(goal, rows, jacobian[:m], bound[:m], 3000, 1e-13)
        assert rows.x == pytest.approx(slow(goal, jacobian[:m], bound[:m], factor.T @ factor), abs=1e-5)


@pytest.mark.parametrize("seed", range(6))
def test_contact_rows_only(seed: int) -> None:
    rng = np.random.default_rng(seed)
    goal, rows = arrays(8, rng)
    jacobian, bound = rng.normal(size=(4, 8)), rng.uniform(-1.0, 0.0, 4)
    count, _ = solve(goal, rows, jacobian, bound, 3000, 1e-13)
    assert count == 4
    assert (jacobian @ rows.x >= bound - 1e-5).all()
    assert rows.x == pytest.approx(slow(goal, jacobian, bound), abs=1e-4)


@pytest.mark.parametrize("seed", range(6))
def test_bounds_that_are_violated_join(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    goal, rows = arrays(6, rng)
    goal.low[:], goal.high[:] = -0.6, 0.4
    jacobian, bound = rng.normal(size=(2, 6)), rng.uniform(-0.3, 0.0, 2)
    count, _ = solve(goal, rows, jacobian, bound, 3000, 1e-13)
    assert count > 2
    assert (rows.x >= goal.low).all() and (rows.x <= goal.high).all()
    assert rows.x == pytest.approx(slow(goal, jacobian, bound), abs=1e-4)


def test_without_rows_the_wish_is_clipped() -> None:
    goal, rows = arrays(5, np.random.default_rng(0))
    goal.high[2] = goal.step[2] - 0.1
    goal.low[3] = goal.step[3] + 0.2
    count, _ = solve(goal, rows, np.zeros((0, 5)), np.zeros(0), 15, 1e-9)
    assert count == 0
    assert (rows.x == np.clip(goal.step, goal.low, goal.high)).all()


def test_a_row_that_the_wish_obeys_changes_nothing() -> None:
    goal, rows = arrays(5, np.random.default_rng(0))
    jacobian = goal.step[None, :] / np.linalg.norm(goal.step)
    solve(goal, rows, jacobian, np.array([-1.0]), 15, 1e-9)
    assert (rows.x == goal.step).all() and rows.multiplier[0] == 0.0


def test_the_same_row_twice_is_shared_and_solved() -> None:
    goal, rows = arrays(4, np.random.default_rng(2))
    jacobian = np.tile([1.0, 0.0, 0.0, 0.0], (2, 1))
    solve(goal, rows, jacobian, np.full(2, goal.step[0] + 1.0), 500, 1e-12)
    assert rows.x[0] == pytest.approx(goal.step[0] + 1.0, abs=1e-4)


def test_rows_that_contradict_each_other_end_in_finite_numbers_inside_the_bounds() -> None:
    goal, rows = arrays(4, np.random.default_rng(3))
    goal.low[:], goal.high[:] = -2.0, 2.0
    jacobian = np.array([[1.0, 0.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]])
    count, used = solve(goal, rows, jacobian, np.array([1.0, 1.0, 1.0]), 500, 1e-12)
    assert np.isfinite(rows.x).all() and (np.abs(rows.x) <= 2.0).all()
    assert (rows.multiplier[:count] <= MULTIPLIER_CAP).all() and used > 0


@pytest.mark.parametrize("where", ["wish", "jacobian", "bound", "weight"])
def test_a_nan_never_leads_outside_the_bounds_unseen(where: str) -> None:
    """Either the step is inside its bounds, or it is a nan, which the certificate must refuse."""
    goal, rows = arrays(4, np.random.default_rng(4))
    goal.low[:], goal.high[:] = -0.3, 0.3
    jacobian, bound = np.ones((1, 4)), np.ones(1)
    {"wish": goal.step, "jacobian": jacobian[0], "bound": bound, "weight": goal.inverse_weight}[where][0] = np.nan
    solve(goal, rows, jacobian, bound, 15, 1e-9)
    assert (np.isnan(rows.x) | (np.abs(rows.x) <= 0.3)).all()


def test_a_full_table_takes_no_more_bounds() -> None:
    rng = np.random.default_rng(5)
    goal, rows = arrays(10, rng)
    goal.low[:], goal.high[:] = -0.01, 0.01
    m = len(rows.bound)
    count, _ = solve(goal, rows, rng.normal(size=(m, 10)), np.full(m, -0.1), 5, 1e-9)
    assert count == m and (np.abs(rows.x) <= 0.01).all()
