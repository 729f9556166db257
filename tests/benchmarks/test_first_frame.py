"""The first frame after `load` against the median frame: which one is long, and which scene has none."""

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks import first_frame
from benchmarks.__main__ import main
from benchmarks.first_frame import REFUSED, Row, alone, attempt

GOOD = Row("ball_drop", "default", 0.5, 30.0, 6.0, 5.0, 0)


def test_a_scene_is_run_in_a_process_of_its_own(tmp_path: Path) -> None:
    assert main(["first-frame", "--filter", "ball_drop", "--quick", "--run", str(tmp_path)]) in (0, 1)
    (row,) = csv.DictReader((tmp_path / "first_frame.csv").read_text().splitlines())
    assert row["scene"] == "ball_drop" and row["late_kernels"] == "0" and float(row["load_s"]) > 0.0
    assert float(row["ratio"]) == pytest.approx(float(row["first_us"]) / float(row["median_us"]), rel=1e-4)


def test_a_scene_without_a_first_frame_has_the_reason() -> None:
    assert attempt("start_inside", "default", 3) == REFUSED
    assert str(alone("ball_drop", "printed", 3)).startswith("UnknownName")


@pytest.mark.parametrize(("found", "code"), [
    (GOOD, 0), (replace(GOOD, ratio=10.0), 0), (replace(GOOD, ratio=10.1), 1), (replace(GOOD, late_kernels=1), 1),
    (replace(GOOD, ratio=float("nan")), 1), (REFUSED, 0), ("ImportError: no such data", 3),
])
def test_a_long_first_frame_a_late_kernel_and_a_scene_that_fails_are_faults(
    found: Row | str, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(first_frame, "alone", lambda scene, preset, frames: found)
    assert main(["first-frame", "--filter", "ball_drop", "--run", str(tmp_path)]) == code


def test_a_long_first_frame_is_measured_again_and_a_late_kernel_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    answers = [replace(GOOD, ratio=60.0), replace(GOOD, ratio=4.0), replace(GOOD, ratio=7.0, late_kernels=1), GOOD]

    class Pool:
        def __init__(self, *_: object) -> None: ...

        def __enter__(self) -> "Pool":
            return self

        def __exit__(self, *_: object) -> None: ...

        def submit(self, *_: object) -> "Pool":
            return self

        def result(self) -> Row:
            return answers.pop(0)

    monkeypatch.setattr(first_frame, "ProcessPoolExecutor", Pool)
    again, late = alone("s", "default", 3), alone("s", "default", 3)
    assert isinstance(again, Row) and isinstance(late, Row)
    assert again.ratio == 4.0 and again.good and late.late_kernels == 1 and not late.good and answers == [GOOD]


def test_a_pattern_that_matches_nothing_is_refused(tmp_path: Path) -> None:
    assert main(["first-frame", "--filter", "no_such_scene", "--run", str(tmp_path)]) == 2
