"""Numbers read right, at the edges of every prefix too."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reports.words.wording import count, figures, limit, listed, quantity, ratio

SIZES = {"m": 1.0, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9}


@pytest.mark.parametrize(("value", "unit", "text"), [
    (None, "m", "—"), (math.nan, "m", "NaN"), (math.inf, "us", "infinite"), (0.0, "m", "0"), (0.0, "%", "0 %"),
    (0.0, "deg", "0"), (2e-16, "m", "< 1 nm"), (0.9e-9, "m", "< 1 nm"), (1.2e-9, "m", "1.20 nm"),
    (3e-7, "m", "300 nm"), (0.9997e-3, "m", "1.00 mm"), (0.0123, "m", "12.3 mm"), (2.0, "m", "2.00 m"),
    (31.0, "us", "31.0 µs"), (16_666.0, "us", "16.7 ms"), (12.3, "deg", "12.3°"), (40.0, "%", "40.0 %"),
    (4.0, "frames", "4"), (0.0, "frames", "0"), (3.3, "J", "3.30 J"),
])
def test_quantities(value: float | None, unit: str, text: str) -> None:
    assert quantity(value, unit) == text


@given(st.floats(1e-9, 900.0))
def test_a_length_reads_back_to_three_figures(value: float) -> None:
    number, unit = quantity(value, "m").split()
    assert float(number) * SIZES[unit] == pytest.approx(value, rel=5.1e-3)


@pytest.mark.parametrize(("value", "text"), [(9.999, "10.0"), (99.96, "100"), (1234.0, "1,234"), (1e-5, "1.0·10⁻⁵")])
def test_figures(value: float, text: str) -> None:
    assert figures(value) == text


def test_limits_lose_the_zeros_that_only_speak_of_measuring() -> None:
    assert [limit(1e-6, "m"), limit(0.01, ""), limit(1e5, "us"), limit(None, "m"), limit(0.0, "m")] == [
        "1 µm", "0.01", "100 ms", "—", "0"]


@pytest.mark.parametrize(("value", "text"), [
    (None, "—"), (math.nan, "—"), (1.0, "best"), (1.003, "level"), (1.04, "×1.04"), (2.44, "×2.4"), (12.4, "×12"),
    (1000.0, "×1,000"), (13_333.0, "more than ×1,000"), (3e7, "more than ×1,000"), (math.inf, "against 0"),
])
def test_ratios(value: float | None, text: str) -> None:
    assert ratio(value) == text


def test_lists_and_counts() -> None:
    assert count(1, "run") == "1 run" and count(0, "run") == "0 runs"
    assert listed(("a", "b", "c"), most=2) == "a, b and 1 more"
