"""Tables that other commands add to a run are read as they were written; a missing one is no table, a damaged one is named."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports.summaries import baseline
from reports.tables.effects import effects
from reports.tables.hard_cases import trials
from reports.tables.settings import settings
from tests.reports.small_runs import effect, write_effects

READERS: dict[str, Callable[[Path], object]] = {
    "ablation.json": effects,
    "stability.csv": trials,
    "sweep.csv": settings,
    "kept.csv": lambda folder: baseline.load(folder / "kept.csv"),
}
KEPT = "scenario,run,metric,unit,value\n"
DAMAGED = {
    "ablation.json": [
        "{",
        "[]",
        "{}",
        '{"lines": 3}',
        '{"lines": [{"share": 1}]}',
        *(json.dumps({"lines": [one]}) for one in (3, effect("a", "b", "much"), effect("a", "b", "NaN"))),
    ],
    "stability.csv": ["case,run\na,b\n", 'case,run\n"a', "case,run\na,b,c,d\n"],
    "sweep.csv": ["scenario,engine\na,b\n", 'scenario,"'],
    "kept.csv": [KEPT, "scenario,run\na,b\n", '"', *(f"{KEPT}a,b/c,d,m,{value}\n" for value in ("", "much", "inf"))],
}


@pytest.mark.parametrize(
    ("name", "content"),
    [(name, content.encode()) for name, contents in DAMAGED.items() for content in contents]
    + [(name, content) for name in READERS for content in (b"", b"\xff\xfe\x00\x01")],
)
def test_a_damaged_file_is_named(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InvalidFile, match=re.escape(name)):
        READERS[name](tmp_path)


def test_a_missing_table_is_none_and_a_missing_baseline_is_named(tmp_path: Path) -> None:
    assert effects(tmp_path) is trials(tmp_path) is settings(tmp_path) is None
    with pytest.raises(InvalidFile, match=r"kept\.csv"):
        READERS["kept.csv"](tmp_path)


def test_effects_come_back_but_for_those_that_were_not_switched(tmp_path: Path) -> None:
    """An effect may take all of the frame, none of it, or save time."""
    lines = [("a", "coupling", 0.6), ("b", "sleeping", -3.0), ("b", "dynamics", 1.0), ("c", "limits", 0.0)]
    broken = [["course_error_max", 1e-3, None, 1e-6]]
    write_effects(
        tmp_path, *(effect(*line, broken=broken if line[0] == "a" else []) for line in lines), effect("b", "friction", None)
    )
    table = effects(tmp_path)
    assert table is not None and list(zip(table.scenario, table.effect, table.share, strict=True)) == lines
    assert [list(one) for one in table.broken] == [["course_error_max"], [], [], []]
