"""The vector code of sights and gifts against its Python, bit for bit, and the two kinds of each against one another."""

import numpy as np
import pytest

from avatarsim.impact.contacts import MOTION, ROW
from avatarsim.impact.four_at_once import give, give_along_normal, wishes
from avatarsim.impact.solver_rows import ALL_WISHES, LANES, WISH, WISH_SIZE
from avatarsim.impact.visit import wish_along_normal
from avatarsim.kernel import kernel

pytestmark = pytest.mark.nojit
BODIES, POINTS = 5, 7


@kernel
def compiled_wishes(rows: np.ndarray, k: int, motion: np.ndarray, a: int, b: int) -> tuple[float, float, float]:
    """As kernels call it; under NUMBA_DISABLE_JIT the Python itself."""
    return wishes(rows, k, motion, a, b)


@kernel
def compiled_give(rows: np.ndarray, k: int, d: tuple[float, float, float], motion: np.ndarray, a: int, b: int) -> None:
    give(rows, k, d, motion, a, b)


@kernel
def compiled_along_normal(rows: np.ndarray, k: int, d: float, motion: np.ndarray, a: int, b: int) -> None:
    give_along_normal(rows, k, d, motion, a, b)


def table(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows and velocities at random, as they are laid out: the last of each four is zero."""
    rng = np.random.default_rng(seed)
    rows, motion = rng.normal(size=(POINTS, ROW)), rng.normal(size=(BODIES, MOTION))
    for start, stop in ((0, WISH), (ALL_WISHES, 100)):
        rows[:, start + LANES - 1 : stop : LANES] = 0.0
    rows[:, WISH : WISH + WISH_SIZE] = rows[:, ALL_WISHES : ALL_WISHES + LANES * WISH_SIZE : LANES]
    motion[:, LANES - 1 :: LANES] = 0.0
    return rows, motion


def pairs(seed: int) -> list[tuple[int, int, int]]:
    """Contacts and two bodies of each."""
    rng = np.random.default_rng(seed)
    return [(k, *(int(b) for b in rng.choice(BODIES, 2, replace=False))) for k in range(POINTS)]


@pytest.mark.parametrize("seed", range(20))
def test_wishes_are_those_of_the_python(seed: int) -> None:
    rows, motion = table(seed)
    for k, a, b in pairs(seed):
        found = compiled_wishes(rows, k, motion, a, b)
        assert found == wishes(rows, k, motion, a, b)
        assert found[0] == wish_along_normal(rows, k, motion, a, b)


@pytest.mark.parametrize("seed", range(20))
def test_gifts_are_those_of_the_python_and_one_along_the_normal_is_one_of_all(seed: int) -> None:
    rows, motion = table(seed)
    rng = np.random.default_rng(seed)
    for k, a, b in pairs(seed):
        d = tuple(float(x) for x in rng.normal(size=3))
        twin, lone, whole = motion.copy(), motion.copy(), motion.copy()
        compiled_give(rows, k, d, motion, a, b)
        give(rows, k, d, twin, a, b)
        np.testing.assert_array_equal(motion, twin)
        compiled_along_normal(rows, k, d[0], lone, a, b)
        give(rows, k, (d[0], 0.0, 0.0), whole, a, b)
        np.testing.assert_array_equal(lone, whole)
        give_along_normal(rows, k, d[0], twin, a, b)
        compiled_along_normal(rows, k, d[0], motion, a, b)
        np.testing.assert_array_equal(motion, twin)
