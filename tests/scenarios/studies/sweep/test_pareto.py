"""The Pareto front against the definition, point by point."""

import math

from hypothesis import given
from hypothesis import strategies as st

from scenarios.studies.sweep.rows import Point, beats, front

FEW = st.sampled_from([0.0, 1.0, 2.0, 3.0, 1e-9, math.inf, math.nan])


def brute(points: list[Point]) -> list[bool]:
    finite = [point for point in points if all(map(math.isfinite, point))]
    return [point in finite and not any(beats(other, point) for other in finite) for point in points]


@given(st.lists(st.tuples(FEW, FEW), max_size=12))
def test_it_is_the_definition(points: list[Point]) -> None:
    assert front(points) == brute(points)


@given(st.lists(st.tuples(st.floats(0, 1e6), st.floats(0, 1)), max_size=40))
def test_it_is_the_definition_for_any_numbers(points: list[Point]) -> None:
    assert front(points) == brute(points)


def test_equals_share_the_front_and_nothing_is_on_none() -> None:
    assert front([(1.0, 2.0), (1.0, 2.0), (2.0, 1.0), (2.0, 2.0)]) == [True, True, True, False]
    assert front([(math.nan, 0.0), (0.0, math.inf)]) == [False, False] and front([]) == []
