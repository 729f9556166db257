"""The table of cleaned clips: a row for each, and what is broken is said."""

from dataclasses import replace

import pytest

from avatarsim.cleaning import Options
from scenarios import cleaned
from scenarios.catalog.recorded.mocap_clips import PLAYED

WALK = next(played for played in PLAYED if played.clip == "walk")


def test_a_clip_is_cleaned_and_told_in_a_row(capsys: pytest.CaptureFixture[str], tmp_path: object) -> None:
    file = f"{tmp_path}/table.md"
    assert cleaned.main(["--clips", "walk", "--rooms", "floor", "--save", file]) == 0
    text = capsys.readouterr().out
    line = next(line for line in text.splitlines() if line.startswith("| walk"))
    assert [cell.strip() for cell in line.strip("|").split("|")][:9] == [
        "walk", "floor", "1.3", "39", "4", "5.3", "5", "0.01", "0 + 0",
    ]
    with open(file, encoding="utf-8") as saved:
        assert line in saved.read() and "broken" not in text


def test_a_promise_that_is_broken_is_named() -> None:
    row = cleaned.row_of(WALK, "floor", Options(opinion=False))
    assert row.broken == ()
    as_it_was = replace(row.cleaned, motion=row.motion, after=row.cleaned.before)
    broken = replace(row, cleaned=as_it_was, judged_after=row.judged_before, judged_between=row.judged_before)
    assert broken.broken == ("overlap in a frame", "overlap between frames", "a way not proved", "limits")
    moved = replace(row.cleaned, changed=row.cleaned.changed & False)
    assert replace(row, cleaned=moved).broken == ("a frame rewritten",)


def test_a_clip_that_is_not_there_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        cleaned.main(["--clips", "waltz"])
    assert "waltz" in capsys.readouterr().err
