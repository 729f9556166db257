"""Multipliers by the active set against non-negative least squares."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.ik.qp import finish
from avatarsim.ik.state import ACTIVE_CAP, MOST_PRESSED, ConstraintRows
from tests.ik.least_distance import least_distance
from tests.ik.solvers import TREES, solver_of

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
ROWS = solver_of(TREES).working.rows
TOLERANCE = 1e-9


def rows_of(rows: np.ndarray, bound: np.ndarray, multiplier: np.ndarray) -> ConstraintRows:
    """Rows of a least-distance problem, as sweeps that came to those multipliers leave them."""
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
    assert finish(TOLERANCE, found)
    pressing = found.multiplier[:m]
    assert (pressing >= 0.0).all() and rows.T @ pressing == pytest.approx(wanted, abs=1e-6)
    assert found.residual[:m] == pytest.approx(rows @ wanted - bound, abs=1e-6), "residuals are kept up to date"


@given(st.integers(0, 10**6))
def test_rows_that_all_but_say_the_same_are_met(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=9) + 1e-4 * rng.normal(size=(4, 9))
    bound = rng.uniform(0.9, 1.0, 4) * 0.05
    found = rows_of(rows, bound, np.zeros(4))
    if finish(1e-6, found):
        assert (rows @ rows.T @ found.multiplier[:4] >= bound - 1e-8).all()
    else:
        assert (found.multiplier[:4] == 0.0).all()


def test_conditions_that_cannot_all_be_met_leave_the_multipliers_as_they_were() -> None:
    rows = np.array([[1.0, 0.0], [-1.0, 0.0]])
    begin = np.array([0.25, 0.0])
    found = rows_of(rows, np.array([1.0, 1.0]), begin)
    assert not finish(TOLERANCE, found)
    assert (found.multiplier[:2] == begin).all() and (found.multiplier[:2] < MOST_PRESSED).all()


def test_more_active_rows_than_there_is_room_for_are_left_to_the_sweeps() -> None:
    m = ACTIVE_CAP + 1
    begin = np.full(m, 0.5)
    found = rows_of(np.eye(m), np.ones(m), begin)
    assert not finish(TOLERANCE, found) and (found.multiplier[:m] == begin).all()
    found = rows_of(np.eye(m - 1), np.ones(m - 1), begin[1:])
    assert finish(TOLERANCE, found) and found.multiplier[: m - 1] == pytest.approx(1.0, rel=1e-8)
