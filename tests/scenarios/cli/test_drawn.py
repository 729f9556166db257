"""Drawn scenes and motions by seed: a broken bound fails the command and is named; the look of a motion never fails it."""

import json
from pathlib import Path
from typing import Any

import pytest

from scenarios import drawn_crowds
from scenarios.__main__ import main
from scenarios.cli.drawn import picked

SHORT = ["drawn", "--frames", "3", "--jobs", "0", "--seed", "42"]
"""In three frames all bodies fall and hardly any touch yet."""


def rows(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, list[dict[str, Any]]]:
    code = main([*SHORT, *words, "--json"])
    return code, json.loads(capsys.readouterr().out)


def test_every_motion_in_every_room_and_crowds_with_rising_seeds() -> None:
    found = picked(None, 10, 3)
    rooms = {name for name, _ in found if name.startswith("unseen_")}
    assert len(rooms) == 6 and {(room, 10 + k) for room in rooms for k in range(3)} < set(found)
    assert found[-3:] == [(drawn_crowds.draw(seed).name, seed) for seed in (10, 11, 12)]
    assert picked("crowd_swept_*", 3, 2) == [("crowd_swept_8", 8), ("crowd_swept_14", 14)]
    assert picked("unseen_wall", 3, 1) == [("unseen_wall", 3)] and picked("unseen_wal", 3, 1) == []


def test_falling_bodies_pass_and_frozen_ones_fail(site: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, found = rows(capsys, "--filter", "crowd_*", "--count", "5")
    assert code == 0 and {row["scenario"].split("_")[1] for row in found} == {"poured", "struck", "swept", "gripped", "kicked"}
    code, found = rows(capsys, "--filter", "crowd_poured_*", "--count", "1", "--engine", "frozen")
    failed = {row["metric"] for row in found if row["status"] == "fail"}
    assert code == 1 and {"time_kept_error", "travel_missing"} <= failed and {row["seed"] for row in found} == {42}


def test_an_engine_beside_the_first_breaks_nothing(site: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, found = rows(capsys, "--filter", "crowd_poured_*", "--count", "1", "--engine", "avatarsim", "frozen")
    assert code == 0 and {row["status"] for row in found if row["engine"] == "frozen"} == {"info"}
    assert main([*SHORT, "--filter", "crowd_poured_*", "--count", "1", "--engine", "frozen"]) == 1
    said = capsys.readouterr().out
    assert "crowd_poured_42 --seed 42" in said and "time_kept_error" in said


def test_motion_without_an_occasion_breaks_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    code, found = rows(capsys, "--filter", "unseen_floor", "--count", "1")
    unsettled = [row for row in found if row["metric"] == "own_acceleration_rms"]
    assert code == 0 and [(row["value"], row["status"]) for row in unsettled] == [(None, "info")]


def test_an_engine_that_raises_and_wrong_words(site: Path) -> None:
    assert main([*SHORT, "--frames", "4", "--filter", "crowd_poured_*", "--count", "1", "--engine", "avatarsim", "raises"]) == 3
    for words in (["--count", "0"], ["--seed", "-1"], ["--engine", "nobody"], ["--engine", "frozen", "--preset", "no"]):
        assert main([*SHORT, *words]) == 2
    assert main([*SHORT, "--filter", "crowd_pured_*"]) == 5
