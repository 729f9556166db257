"""The command on drawn crowds: figures of every run, and an exit code that says whether the first engine is within the bounds."""

from pathlib import Path

import pytest

from scenarios.drawn_crowds.__main__ import main

FALLS = ["--seed", "42", "--frames", "3", "--jobs", "2"]
"""In three frames all fall and hardly anything touches yet."""


def test_bodies_that_fall_are_within_the_bounds_and_bodies_that_freeze_are_not(
    site: Path, capsys: pytest.CaptureFixture[str],
) -> None:
    assert main([*FALLS, "--scenes", "5"]) == 0
    said = capsys.readouterr().out
    kinds = "poured_42", "struck_43", "swept_44", "gripped_45", "kicked_46"
    assert "--seed 42" in said and all(f"crowd_{kind}" in said for kind in kinds)
    assert main([*FALLS, "--scenes", "2", "--engines", "frozen/default"]) == 1
    (poured, *_) = [row for row in capsys.readouterr().out.splitlines() if row.startswith("crowd_poured_42")]
    assert "lost time" in poured and "unfallen m" in poured


def test_an_engine_beside_the_first_breaks_nothing(site: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*FALLS, "--scenes", "1", "--engines", "avatarsim/default", "frozen/other"]) == 0
    summary = [row.split() for row in capsys.readouterr().out.splitlines() if " any " in row]
    assert [(row[0], row[-2:]) for row in summary] == [("avatarsim/default", ["0", "1"]), ("frozen/other", ["1", "1"])]


def test_what_does_not_run_and_what_is_asked_wrongly(site: Path) -> None:
    one = ["--seed", "41", "--frames", "4", "--jobs", "1", "--scenes", "1"]
    assert main([*one, "--engines", "avatarsim/default", "raises/default"]) == 3
    for words in (["--scenes", "0"], ["--seed", "-1"], ["--engines", "nobody/default"], ["--engines", "frozen/no"]):
        assert main(words) == 2
