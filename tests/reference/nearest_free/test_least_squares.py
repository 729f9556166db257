"""Least squares under inequalities against scipy's general solver."""

import numpy as np
import pytest
from scipy.optimize import minimize

from reference.nearest_free.least_squares import giving_way, least_squares


@pytest.mark.parametrize("seed", range(20))
def test_the_optimum_is_that_of_a_general_solver(seed):
    random = np.random.default_rng(seed)
    n, m = 5, 7
    rates, error, rows = random.normal(size=(8, n)), random.normal(size=8), random.normal(size=(m, n))
    least = rows @ random.normal(size=n) - random.uniform(0.0, 0.5, m)
    found = least_squares(rates, error, rows, least)
    assert (rows @ found >= least - 1e-9).all()
    other = minimize(
        lambda x: ((rates @ x + error) ** 2).sum(), found + 0.1 * random.normal(size=n), method="SLSQP",
        constraints={"type": "ineq", "fun": lambda x: rows @ x - least}, options={"ftol": 1e-14, "maxiter": 500},
    )
    assert found == pytest.approx(other.x, abs=1e-5)


def test_without_rows_it_is_plain_least_squares():
    random = np.random.default_rng(1)
    rates, error = random.normal(size=(8, 3)), random.normal(size=8)
    assert least_squares(rates, error, np.zeros((0, 3)), np.zeros(0)) == pytest.approx(
        np.linalg.lstsq(rates, -error, rcond=None)[0], abs=1e-9
    )


def test_rows_that_contradict_one_another_have_no_answer_but_may_give_way():
    rows, least = np.array([[1.0], [-1.0], [1.0]]), np.array([-5.0, -5.0, 7.0])
    assert least_squares(np.eye(1), np.zeros(1), rows, least) is None
    # the first two are hard: x stays at most 5, the third is missed by 2
    assert giving_way(np.eye(1), np.zeros(1), rows, least, 2) == pytest.approx([5.0], abs=1e-4)
