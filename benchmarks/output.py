"""Files and tables of the benchmarks."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd

from runfiles.csv_rows import csv_text
from runfiles.files import write_text


def write_rows(path: Path, rows: Sequence[object], kind: type) -> None:
    """Write dataclass rows of one `kind` as CSV, and print the path."""
    write_text(path, csv_text(rows, kind))
    print(path)


def print_rows(title: str, rows: Sequence[Any]) -> None:
    """Print dataclass rows as a table, a line each."""
    print_table(title, pd.DataFrame([asdict(row) for row in rows]).set_index(pd.Index([""] * len(rows))))


def print_pivot(title: str, rows: Sequence[Any], index: Sequence[str], columns: str, value: str) -> None:
    """Print `value` of the rows: a line for each `index`, a column for each entry of `columns`, both in the rows' order."""
    frame = pd.DataFrame([asdict(row) for row in rows])
    print_table(title, frame.set_index([*index, columns])[value].unstack(columns, sort=False))


def print_table(title: str, table: pd.DataFrame) -> None:
    """Print a table below its title; figures to four digits, missing ones as a dash."""
    print(f"\n{title}\n{table.to_string(na_rep='-', float_format=lambda value: f'{value:.4g}')}\n")
