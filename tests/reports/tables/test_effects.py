"""Effects of scenes are read as they were written."""

import json
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports.tables.effects import effects
from tests.reports.small_runs import effect, write_effects


def test_lines_come_back_and_what_was_not_switched_has_none(tmp_path: Path) -> None:
    write_effects(tmp_path, effect("a", "coupling", 0.6), effect("b", "sleeping", -1.5, broken=[]), effect("b", "friction", None))
    table = effects(tmp_path)
    assert table is not None
    assert list(zip(table.scenario, table.effect, table.share, strict=True)) == [("a", "coupling", 0.6), ("b", "sleeping", -1.5)]
    assert [list(one) for one in table.broken] == [["course_error_max"], []]


@pytest.mark.parametrize("share", [1.0, 0.0, -3.0])
def test_an_effect_may_take_all_of_the_frame_or_save_time(tmp_path: Path, share: float) -> None:
    write_effects(tmp_path, effect("a", "dynamics", share, without_us=0.0))
    table = effects(tmp_path)
    assert table is not None and table.share.tolist() == [share]


def test_no_file_is_no_table(tmp_path: Path) -> None:
    assert effects(tmp_path) is None


@pytest.mark.parametrize(
    "content",
    [
        "",
        "{",
        "[]",
        "{}",
        "3",
        '{"lines": 3}',
        '{"lines": [{"share": 1}]}',
        json.dumps({"lines": [effect("a", "b", "much")]}),
        json.dumps({"lines": [effect("a", "b", "NaN")]}),
        json.dumps({"lines": [3]}),
    ],
)
def test_a_damaged_file_is_named(tmp_path: Path, content: str) -> None:
    (tmp_path / "ablation.json").write_text(content, encoding="utf-8")
    with pytest.raises(InvalidFile, match=r"ablation\.json"):
        effects(tmp_path)
