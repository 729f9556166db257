"""Rows of figures as CSV: digits, entries that are no number, and columns even without a row."""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

from benchmarks.output import write_rows


@dataclass(frozen=True)
class Figure:
    name: str
    value: float
    count: int = 0
    held: bool = True


def test_numbers_are_short_and_nan_is_an_empty_cell(tmp_path: Path) -> None:
    rows = [Figure("a,b", 1.0 / 3.0, 7), Figure("lost", math.nan, held=False), Figure("far", math.inf)]
    write_rows(tmp_path / "some.csv", rows, Figure)
    found = list(csv.DictReader((tmp_path / "some.csv").read_text().splitlines()))
    assert found[0] == {"name": "a,b", "value": "0.333333", "count": "7", "held": "True"}
    assert found[1]["value"] == "" and found[1]["held"] == "False" and found[2]["value"] == "inf"
    write_rows(tmp_path / "none.csv", [], Figure)
    assert (tmp_path / "none.csv").read_text() == "name,value,count,held\n"
