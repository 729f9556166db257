"""The minimal standard generator gives its published numbers, and another sequence for another seed."""

import numpy as np

from avatarsim.spatial.random import MODULUS, draw, seeded


def test_ten_thousandth_number_is_the_published_one() -> None:
    # C++ standard, [rand.predef]: the 10000th invocation of a default minstd_rand gives 399268537
    state = np.array([1], dtype=np.int64)
    numbers = [draw(state, MODULUS) for _ in range(10_000)]
    assert numbers[-1] == 399268537


def test_neighbouring_seeds_give_other_numbers_and_equal_seeds_the_same() -> None:
    one, again, other = seeded(1), seeded(1), seeded(2)
    first = [draw(one, 1000) for _ in range(20)]
    assert first == [draw(again, 1000) for _ in range(20)]
    assert first != [draw(other, 1000) for _ in range(20)]


def test_numbers_stay_below_the_bound_and_reach_each() -> None:
    state = seeded(0)
    assert {draw(state, 5) for _ in range(200)} == set(range(5))
