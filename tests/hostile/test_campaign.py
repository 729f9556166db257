"""A campaign finds what it looks for: each bad door by its bad case, with a command that repeats it; all others are asked."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.hostile import campaign as campaigns
from tests.hostile.bad_doors import BAD, DEEDS
from tests.hostile.campaign import Batch, campaign
from tests.hostile.judged import ROOT

COUNT = 5
KINDS = {
    "bad crash": "crash (SIGSEGV)", "bad hang": "hang", "bad memory": "memory", "bad words": "KeyError", "bad nan": "Unsound",
    "bad end": "end of the process with 7",
}


def test_each_bad_case_is_found_by_its_number_and_the_others_are_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # its process has to be ended from outside; how long that waits is no matter here
    monkeypatch.setattr(campaigns, "PATIENCE", 1.0)
    report = campaign([Batch(door, 1, COUNT) for door in DEEDS], 2, tmp_path)
    assert report.asked == dict.fromkeys(DEEDS, COUNT)
    assert {door: kind for door, kind, _, _ in report.found} == KINDS
    for count, said in report.found.values():
        assert count == 1 and f"case {BAD}\n" in said and said.endswith(f"{COUNT} --first {BAD} --last {BAD}")


def test_the_command_repeats_the_one_case() -> None:
    words = [sys.executable, "-m", "tests.hostile.batch", "bad words", "1", f"{COUNT}", "--first", f"{BAD}", "--last", f"{BAD}"]
    lines = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    found, ended = map(json.loads, lines)
    assert (found["case"], found["kind"], ended) == (BAD, "KeyError", {"asked": 1})


def test_a_door_that_crashes_every_time_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(campaigns, "CRASHES", 1)
    report = campaign([Batch("bad crash", 1, COUNT)], 1, tmp_path)
    assert report.asked == {"bad crash": BAD + 1} and sum(count for count, _ in report.found.values()) == 1
