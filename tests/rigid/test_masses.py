"""Tensors in world axes: the short way of diagonal ones against the long way of all, and against matrix products."""

import numpy as np
import pytest

from avatarsim.rigid.contacts import is_diagonal, to_world

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
BODIES = 6


def turns(seed: int) -> np.ndarray:
    """Rotations at random."""
    drawn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(BODIES, 3, 3)))
    return np.ascontiguousarray(drawn * np.linalg.det(drawn)[:, None, None])


@pytest.mark.parametrize("seed", range(5))
def test_diagonal_or_not_it_is_the_product_of_three(seed: int) -> None:
    rng, turn = np.random.default_rng(seed), turns(seed)
    half = rng.normal(size=(BODIES, 3, 3))
    tensors = half @ half.transpose(0, 2, 1)
    for b in range(0, BODIES, 2):
        tensors[b] = np.diag(rng.uniform(0.1, 3.0, 3))
    found = np.zeros_like(tensors)
    for b in range(BODIES):
        assert is_diagonal(tensors, b) == (b % 2 == 0)
        to_world(tensors, turn, b, found)
    np.testing.assert_allclose(found, turn @ tensors @ turn.transpose(0, 2, 1), rtol=1e-13, atol=1e-14)


def test_the_short_way_is_the_long_one_to_the_bit() -> None:
    turn, tensors = turns(7), np.zeros((BODIES, 3, 3))
    tensors[:, range(3), range(3)] = np.random.default_rng(7).uniform(0.1, 3.0, (BODIES, 3))
    found = np.zeros_like(tensors)
    for b in range(BODIES):
        to_world(tensors, turn, b, found)
        for i in range(3):
            for k in range(i, 3):
                total = 0.0
                for x in range(3):
                    for y in range(3):
                        total += turn[b, i, x] * tensors[b, x, y] * turn[b, k, y]
                assert found[b, i, k] == found[b, k, i] == total


@pytest.mark.parametrize("at", [(0, 1), (0, 2), (1, 2), (1, 0), (2, 0), (2, 1)])
def test_one_number_beside_the_diagonal_is_seen(at: tuple[int, int]) -> None:
    tensors = np.tile(np.eye(3), (1, 1, 1))
    assert is_diagonal(tensors, 0)
    tensors[0][at] = 1e-300
    assert not is_diagonal(tensors, 0)
