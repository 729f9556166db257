"""The multipliers found row by row against those of every set of rows that could press, tried one after another."""

from itertools import combinations

import numpy as np
import pytest

from avatarsim.posture.active_set import CHANGES, back_solve, extend, settle
from avatarsim.posture.workspace import PRESSING_CAP, Rows, make_memory
from avatarsim.scene.scene import Scene
from avatarsim.world.world import build
from tests.stability.hostile import hinged_avatar

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
TOLERANCE = 1e-9


def rows_of(gram: np.ndarray, wanted: np.ndarray, multiplier: np.ndarray) -> Rows:
    """Rows with a gram matrix whose residuals are `wanted` where no multiplier is above zero."""
    world = build(Scene("s", avatars=(hinged_avatar(),)))
    rows, m = make_memory(world.geometry, world.skeleton, world.poses).rows, len(wanted)
    rows.gram[:m, :m], rows.multiplier[:m], rows.residual[:m] = gram, multiplier, wanted + gram @ multiplier
    return rows


def slow(gram: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Multipliers, none below zero, that leave no residual below zero, and none where they press: by trying every set."""
    m = len(wanted)
    for pressing in (set_ for size in range(m + 1) for set_ in combinations(range(m), size)):
        multiplier, at = np.zeros(m), list(pressing)
        multiplier[at] = np.linalg.solve(gram[np.ix_(at, at)], -wanted[at])
        if (multiplier >= 0.0).all() and (wanted + gram @ multiplier >= -1e-12).all():
            return multiplier
    raise AssertionError("no set fits")


@pytest.mark.parametrize("seed", range(12))
def test_it_is_what_trying_every_set_finds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    jacobian, wanted = rng.normal(size=(6, 9)), rng.normal(size=6)
    gram = jacobian @ jacobian.T
    rows = rows_of(gram, wanted, np.maximum(0.0, rng.normal(size=6)) if seed % 2 else np.zeros(6))
    assert settle(rows, 6, TOLERANCE)
    assert rows.multiplier[:6] == pytest.approx(slow(gram, wanted), abs=1e-6)
    assert rows.residual[:6] == pytest.approx(wanted + gram @ rows.multiplier[:6], abs=1e-9)
    assert rows.residual[:6].min() > -1e-6


@pytest.mark.parametrize("seed", range(6))
def test_rows_that_all_but_say_the_same(seed: int) -> None:
    """Four corners of a foot that nearly agree, one of them to the bit: dozens of sweeps would leave them far off."""
    rng = np.random.default_rng(seed)
    jacobian = rng.normal(size=6) + 1e-3 * rng.normal(size=(5, 6))
    jacobian[4] = jacobian[0]
    wanted = -rng.uniform(0.01, 0.02, 5)
    wanted[4] = wanted[0]
    rows = rows_of(jacobian @ jacobian.T, wanted, np.zeros(5))
    assert settle(rows, 5, TOLERANCE)
    step = jacobian.T @ rows.multiplier[:5]
    assert (jacobian @ step + wanted > -1e-7).all() and rows.multiplier[:5].min() >= 0.0
    # where a row presses its condition holds with nothing to spare
    assert ((jacobian @ step + wanted < 1e-7) | (rows.multiplier[:5] == 0.0)).all()


def test_between_two_walls_the_multipliers_stay_as_they_were() -> None:
    one, before = np.array([1.0, 0.5]), np.array([0.3, 0.1])
    jacobian = np.array([one, -one])
    rows = rows_of(jacobian @ jacobian.T, np.array([-0.1, -0.1]), before)
    assert not settle(rows, 2, TOLERANCE)
    assert rows.multiplier[:2].tolist() == before.tolist()


def test_more_rows_than_are_solved_for_together_stay_as_they_were() -> None:
    m = PRESSING_CAP + 1
    rows = rows_of(np.eye(m), -np.ones(m), np.ones(m))
    assert not settle(rows, m, TOLERANCE) and rows.multiplier[:m].tolist() == [1.0] * m
    rows = rows_of(np.eye(m), -np.ones(m), np.zeros(m))
    assert CHANGES < m and not settle(rows, m, TOLERANCE) and not rows.multiplier[:m].any()


def test_a_number_that_is_none_is_no_answer() -> None:
    rows = rows_of(np.eye(2), np.array([-1.0, np.nan]), np.array([0.5, 0.5]))
    assert not settle(rows, 2, TOLERANCE)


@pytest.mark.parametrize("done", range(4))
def test_the_factor_goes_on_from_any_row(done: int) -> None:
    rng = np.random.default_rng(done)
    jacobian, pressing = rng.normal(size=(6, 8)), np.array([4, 0, 3, 5])
    gram, factor, change = jacobian @ jacobian.T, np.zeros((4, 4)), np.zeros(4)
    assert extend(gram, pressing, 0, done, factor) and extend(gram, pressing, done, 4, factor)
    part, residual = gram[np.ix_(pressing, pressing)], rng.normal(size=6)
    lower = np.tril(factor, -1) + np.diag(1.0 / np.diag(factor))
    assert lower == pytest.approx(np.linalg.cholesky(part), abs=1e-6)
    back_solve(residual, pressing, 4, factor, change)
    assert part @ change == pytest.approx(-residual[pressing], abs=1e-6)
    assert not extend(-gram, pressing, 0, 4, factor)
