"""Figures of cleaned clips, and promises that are broken."""

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Options, clean
from avatarsim.scene.scene import Scene
from benchmarks.__main__ import main
from benchmarks.cleaning import judged, motion_of
from benchmarks.growth_scenes import ground
from reference.judging.judge import Judge
from scenarios.building.avatars.humanoid import humanoid
from scenarios.catalog.recorded.mocap_clips import PLAYED


def test_a_clip_is_cleaned_and_has_a_row(tmp_path: Path) -> None:
    assert main(["cleaning", "--quick", "--run", str(tmp_path)]) == 0
    (row,) = csv.DictReader((tmp_path / "cleaning.csv").read_text().splitlines())
    assert (row["clip"], row["room"], row["frames"], row["overlap"], row["unproved"]) == ("walk", "floor", "39", "4", "5")
    assert float(row["deepest_mm"]) == pytest.approx(5.3, abs=0.1) and float(row["seconds"]) == pytest.approx(1.27, abs=0.01)
    assert (row["overlap_after"], row["overlap_between"], row["unproved_after"], row["broken"]) == ("0", "0", "0", "")


def test_a_promise_that_is_broken_is_named() -> None:
    motion, human, floor = motion_of(next(played for played in PLAYED if played.clip == "walk")), humanoid(), ground(40.0)
    cleaned = clean(motion, Model(human, None, (), ()), (floor,), Options(opinion=False))
    judge = Judge(Scene("cleaned", (floor,), (human,)))
    assert judged("walk", "floor", motion, cleaned, judge, 1.0).broken == ""
    as_it_was = judged("walk", "floor", motion, replace(cleaned, motion=motion, after=cleaned.before), judge, 1.0)
    assert len(as_it_was.broken.split("; ")) == 4 and as_it_was.overlap_after == 4 and as_it_was.overlap_between > 0


def test_a_clip_and_a_room_that_are_not_there_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cleaning", "--clips", "waltz", "--run", str(tmp_path)]) == 2 and "waltz" in capsys.readouterr().err
    assert main(["cleaning", "--rooms", "attic", "--run", str(tmp_path)]) == 2 and "attic" in capsys.readouterr().err
