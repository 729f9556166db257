"""The first frame after `load` against the median frame: which one is long, and which scene has none."""

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks import first_frame
from benchmarks.__main__ import main
from benchmarks.first_frame import Row, best

GOOD = Row("ball_drop", "default", 0.5, 30.0, 6.0, 5.0)


def test_a_scene_is_run_in_a_process_of_its_own(tmp_path: Path) -> None:
    assert main(["first-frame", "--filter", "ball_drop", "--quick", "--run", str(tmp_path)]) in (0, 1)
    (row,) = csv.DictReader((tmp_path / "first_frame.csv").read_text().splitlines())
    assert row["scene"] == "ball_drop" and float(row["load_s"]) > 0.0
    assert float(row["ratio"]) == pytest.approx(float(row["first_us"]) / float(row["median_us"]), rel=1e-4)
    assert main(["first-frame", "--filter", "no_such_scene", "--run", str(tmp_path)]) == 2


@pytest.mark.parametrize(("found", "code"), [
    (GOOD, 0), (replace(GOOD, ratio=10.0), 0), (replace(GOOD, ratio=10.1), 1), (replace(GOOD, ratio=float("nan")), 1),
    ("StartOverlaps: a in b", 0), ("ImportError: no such data", 3),
])
def test_a_long_first_frame_and_a_scene_that_fails_are_faults(
    found: Row | str, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(first_frame, "best", lambda scene, preset, frames: found)
    assert main(["first-frame", "--filter", "ball_drop", "--run", str(tmp_path)]) == code


def test_a_long_first_frame_is_measured_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """And a scene without one has the reason."""
    assert str(best("ball_drop", "printed", 3)).startswith("UnknownName")
    answers = [replace(GOOD, ratio=60.0), replace(GOOD, ratio=4.0), GOOD]
    monkeypatch.setattr(first_frame, "measure", lambda scene, preset, frames: answers.pop(0))
    assert best("s", "default", 3) == replace(GOOD, ratio=4.0) and answers == [GOOD]
