"""The README's table is what the command writes from the committed figures, and nothing else."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports import headline
from reports.__main__ import HEADLINE, README
from reports.load import load

Json = dict[str, object]
Write = Callable[[object], Path]


def test_the_readme_holds_what_the_committed_figures_say() -> None:
    text = README.read_text(encoding="utf-8")
    assert headline.replaced(text, headline.block(headline.load(HEADLINE))) == text


def test_the_readme_s_pictures_are_there_and_small() -> None:
    found = re.findall(r"!\[([^\]]+)\]\(([^)]+)\)", README.read_text(encoding="utf-8"))
    assert len(found) == 2 and all(len(words) > 40 for words, _ in found)
    sizes = [(README.parent / path).stat().st_size for _, path in found]
    assert all(10_000 < size < 400_000 for size in sizes)


def test_from_a_run_to_words(run_dir: Write, results: Json, tmp_path: Path) -> None:
    path = tmp_path / "headline.csv"
    path.write_text(headline.numbers(load(run_dir(results))))
    words = headline.block(headline.load(path))
    assert words.startswith("Measured on some cores of Abacus 9, Python 3.11.\n")
    assert "| arm_wall | overlap | **300 nm** | 4.00 mm | 60.0 µm | 10.0 µm | 100 mm |" in words
    assert "|  | frame time | **31.0 µs** | 190 µs | 420 µs | 880 µs | — |" in words
    # ours loses here, and a run that crashed has no number
    assert "| ball_drop | error to closed form | 0.3 | — | — | **0.02** | — |" in words


def test_times_stand_with_their_protocol_beside_those_from_python_and_with_the_machine(
    run_dir: Write, results: Json, tmp_path: Path
) -> None:
    rows, provenance = results["rows"], results["provenance"]
    assert isinstance(rows, list) and isinstance(provenance, dict)
    mixed = "3 x 200 frames, 30 warm-up frames; moving 40 us, resting 3 us"
    times = [row | {"note": mixed} if row["metric"] == "frame_time_p50" else row for row in rows]
    for run, value in (("avatarsim", 35.5), ("mujoco", 210.0)):
        slow = {"engine": run, "preset": "default", "metric": "frame_time_python_p50", "value": value, "unit": "us"}
        times.append(rows[0] | slow | {"note": "3 x 200 frames, 30 warm-up frames", "bound": None, "status": "info"})
    timing = {"mhz": 2445, "busy_elsewhere": 0.02}
    path = tmp_path / "headline.csv"
    path.write_text(headline.numbers(load(run_dir(results | {"rows": times, "provenance": provenance | {"timing": timing}}))))
    words = headline.block(headline.load(path))
    assert words.startswith("Measured on some cores of Abacus 9 at 2445 MHz, Python 3.11; other work kept 0.02 cores busy while ")
    engine = words.index("|  | frame time, 3 x 200 frames | **31.0 µs** |")
    assert engine < words.index("|  | as called from Python, 3 x 200 frames | **35.5 µs** | 210 µs |")


def test_what_is_no_number_is_said(run_dir: Write, results: Json, tmp_path: Path) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    broken = run_dir(results | {"rows": [rows[0] | {"value": "NaN"}, *rows[1:]]})
    (tmp_path / "headline.csv").write_text(headline.numbers(load(broken)))
    assert "| arm_wall | overlap | NaN |" in headline.block(headline.load(tmp_path / "headline.csv"))


@pytest.mark.parametrize("readme", ["", headline.BEGINS, headline.ENDS + headline.BEGINS, 2 * (headline.BEGINS + headline.ENDS)])
def test_a_readme_without_its_marks_is_left_alone(readme: str) -> None:
    with pytest.raises(InvalidFile, match="marks"):
        headline.replaced(readme, "words")


def test_an_empty_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "headline.csv").write_text(",".join(headline.HEAD) + "\n")
    with pytest.raises(InvalidFile, match="no row"):
        headline.load(tmp_path / "headline.csv")
