"""A figure as text equals its value to three digits."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reports.tables.figures import MISSING, quantity, rounded

SIZES = {"km": 1e3, "m": 1.0, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9, "s": 1e6, "ms": 1e3, "µs": 1.0, "ns": 1e-3}
EXTREMES = ("km", "s", "nm", "ns")
"""Units with the largest and smallest prefixes."""
UNITS = ("m", "us", "deg", "%", "", "frames", "m/s")
values = st.floats(allow_nan=False, allow_infinity=False, width=32)


def read(text: str) -> tuple[float, str]:
    """Return the number and unit of a text."""
    found = re.fullmatch(r"(-?[\d,.]+(?:e[+-]?\d+)?)\s*(.*)", text)
    assert found, text
    return float(found[1].replace(",", "")), found[2]


@given(values)
def test_a_rounded_number_is_within_half_of_its_last_digit(value: float) -> None:
    back, rest = read(rounded(value))
    assert rest == "" and back == pytest.approx(value, rel=0.0051, abs=1e-12)


@given(values.filter(lambda value: abs(value) >= 2e-9), st.sampled_from(["m", "us"]))
def test_a_length_or_time_reads_back(value: float, unit: str) -> None:
    text = quantity(value, unit)
    if text == "0":
        assert abs(value) < 1.1e-3 and unit == "us"
        return
    back, prefix = read(text)
    assert back * SIZES[prefix] == pytest.approx(value, rel=0.0051)
    assert prefix in EXTREMES or 0.999 <= abs(back) <= 1000.0


@given(values, st.sampled_from(UNITS))
def test_no_text_has_more_than_three_digits_but_zeros(value: float, unit: str) -> None:
    digits = re.sub(r"[-,.]", "", quantity(value, unit).split()[0].split("e")[0].rstrip("°")).lstrip("0").rstrip("0")
    assert len(digits) <= 3


@pytest.mark.parametrize("unit", UNITS)
def test_what_is_no_number_is_told_apart_from_what_is_missing(unit: str) -> None:
    texts = [quantity(value, unit) for value in (None, math.nan, math.inf)]
    assert texts[0] == MISSING and len(set(texts)) == 3
    assert not any(character.isdigit() for text in texts for character in text)
    assert rounded(math.nan) == texts[1] and rounded(-math.inf) not in texts
