"""Tables that other commands add to a run are read as written; a missing one gives no table, a damaged one is named."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports.summaries import baseline
from reports.tables.effects import effects
from reports.tables.hard_cases import by_case
from reports.tables.settings import settings
from runfiles.table import STUDIED
from tests.reports.small_runs import effect, write_study

READERS: dict[str, Callable[[Path], object]] = {
    "effects.csv": effects,
    "hard_cases.csv": by_case,
    "settings.csv": settings,
    "kept.csv": lambda folder: baseline.load(folder / "kept.csv"),
}
KEPT = "scenario,run,metric,unit,value\n"
DAMAGED = {
    "effects.csv": ["{", f"{','.join(STUDIED)}\n,,,,,,,,,,,odd,,\n"],
    "hard_cases.csv": ["scenario,engine\na,b\n", 'scenario,run\n"a', "scenario,run\na,b,c,d\n"],
    "settings.csv": [f"{','.join(STUDIED)}\na,b,c,d,e,0,much,m,1,,,info,,\n", 'scenario,"'],
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
    assert effects(tmp_path) is by_case(tmp_path) is settings(tmp_path) is None
    with pytest.raises(InvalidFile, match=r"kept\.csv"):
        READERS["kept.csv"](tmp_path)


def test_effects_come_back_with_shares_and_broken_bounds(tmp_path: Path) -> None:
    """An effect may take all of the frame time, none of it, or save time."""
    lines = [("a", "coupling", 0.6), ("b", "sleeping", -3.0), ("c", "dynamics", 1.0), ("d", "limits", 0.0)]
    parts = [part for line in lines for part in effect(*line, broken=["course_error_max"] if line[0] == "a" else [])]
    write_study(tmp_path, "effects", *parts)
    table = effects(tmp_path)
    assert table is not None and list(zip(table.scenario, table.effect, strict=True)) == [line[:2] for line in lines]
    assert list(table.share) == pytest.approx([line[2] for line in lines])
    assert [list(one) for one in table.broken] == [["course_error_max"], [], [], []]
