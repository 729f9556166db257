"""Files and tables of the benchmarks."""

from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import pandas as pd

from runfiles.files import write_text


def write_rows(path: Path, rows: Sequence[Any], kind: type) -> None:
    """Write dataclass rows of one `kind` as CSV with six significant digits and nothing for NaN, and print the path."""
    table = pd.DataFrame([asdict(row) for row in rows], columns=[entry.name for entry in fields(kind)])
    write_text(path, table.to_csv(index=False, lineterminator="\n", float_format="%.6g"))
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
