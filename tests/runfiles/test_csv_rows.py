"""Rows of figures as CSV: digits, what is no number, and columns even without a row."""

import csv
import math
from dataclasses import dataclass

from runfiles.csv_rows import csv_text


@dataclass(frozen=True)
class Figure:
    name: str
    value: float
    count: int = 0
    held: bool = True


def test_numbers_are_short_and_nan_is_an_empty_cell() -> None:
    text = csv_text([Figure("a,b", 1.0 / 3.0, 7), Figure("lost", math.nan, held=False), Figure("far", math.inf)], Figure)
    found = list(csv.DictReader(text.splitlines()))
    assert found[0] == {"name": "a,b", "value": "0.333333", "count": "7", "held": "True"}
    assert found[1]["value"] == "" and found[1]["held"] == "False" and found[2]["value"] == "inf"
    # columns are named where there is no row
    assert csv_text([], Figure) == "name,value,count,held\n"
