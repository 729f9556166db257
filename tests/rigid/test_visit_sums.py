"""Sums of a sweep of the contact solver: against numpy, and those along the normal alone against those along all three axes."""

import numpy as np
import pytest

from avatarsim.rigid.contacts import MOTION, ROW
from avatarsim.rigid.solver import (
    JACOBIAN,
    JACOBIAN_SIZE,
    JACOBIANS,
    LANES,
    RESPONSE,
    RESPONSE_PARTS,
    TANGENT_RESPONSE,
    apply_impulse,
    apply_normal_impulse,
    normal_stopping_impulse,
    stopping_impulses,
)

pytestmark = pytest.mark.nojit
BODIES, POINTS = 5, 7


def table(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows and velocities at random, as they are laid out: the last of each four is zero."""
    rng = np.random.default_rng(seed)
    rows, motion = rng.normal(size=(POINTS, ROW)), rng.normal(size=(BODIES, MOTION))
    for start, stop in ((0, JACOBIAN), (JACOBIANS, 100)):
        rows[:, start + LANES - 1 : stop : LANES] = 0.0
    rows[:, JACOBIAN : JACOBIAN + JACOBIAN_SIZE] = rows[:, JACOBIANS : JACOBIANS + LANES * JACOBIAN_SIZE : LANES]
    motion[:, LANES - 1 :: LANES] = 0.0
    return rows, motion


def pairs(seed: int) -> list[tuple[int, int, int]]:
    """Contacts and two bodies of each."""
    rng = np.random.default_rng(seed)
    return [(k, *(int(b) for b in rng.choice(BODIES, 2, replace=False))) for k in range(POINTS)]


@pytest.mark.parametrize("seed", range(20))
def test_wishes_are_products_of_levers_and_velocities(seed: int) -> None:
    rows, motion = table(seed)
    for k, a, b in pairs(seed):
        levers = rows[k, JACOBIANS : JACOBIANS + LANES * JACOBIAN_SIZE].reshape(JACOBIAN_SIZE, LANES)[:, :3]
        seen = np.concatenate([motion[a, :3] - motion[b, :3], motion[a, LANES : LANES + 3], -motion[b, LANES : LANES + 3]])
        found = stopping_impulses(rows, k, motion, a, b)
        np.testing.assert_allclose(found, seen @ levers, rtol=0.0, atol=1e-14)
        assert found[0] == normal_stopping_impulse(rows, k, motion, a, b)


@pytest.mark.parametrize("seed", range(20))
def test_gifts_are_products_of_impulses_and_one_along_the_normal_is_one_of_all(seed: int) -> None:
    rows, motion = table(seed)
    rng = np.random.default_rng(seed)
    size = LANES * RESPONSE_PARTS
    for k, a, b in pairs(seed):
        d = tuple(float(x) for x in rng.normal(size=3))
        responses = np.stack([rows[k, at : at + size] for at in (RESPONSE, TANGENT_RESPONSE, TANGENT_RESPONSE + size)])
        given = (np.array(d) @ responses).reshape(2, MOTION)
        expected, lone, whole = motion.copy(), motion.copy(), motion.copy()
        expected[a] += given[0]
        expected[b] -= given[1]
        apply_impulse(rows, k, d, motion, a, b)
        np.testing.assert_allclose(motion, expected, rtol=0.0, atol=1e-14)
        apply_normal_impulse(rows, k, d[0], lone, a, b)
        apply_impulse(rows, k, (d[0], 0.0, 0.0), whole, a, b)
        np.testing.assert_array_equal(lone, whole)
