"""The README's table is what the command writes from the committed figures, and nothing else."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports.__main__ import HEADLINE, README
from reports.reading.load import load
from reports.summaries import headline

ABOUT = README.parent / "reports" / "pictures" / "about.json"
Json = dict[str, object]
Write = Callable[[object], Path]


def test_the_readme_holds_what_the_committed_figures_say() -> None:
    text = README.read_text(encoding="utf-8")
    assert headline.replaced(text, headline.told(headline.load(HEADLINE))) == text


def test_the_readme_s_pictures_are_there_and_small() -> None:
    found = re.findall(r"!\[([^\]]+)\]\(([^)]+)\)", README.read_text(encoding="utf-8"))
    assert len(found) >= 2 and all(len(words) > 40 for words, _ in found)
    sizes = [(README.parent / path).stat().st_size for _, path in found]
    assert all(10_000 < size < 500_000 for size in sizes)


def test_table_and_pictures_are_of_one_run() -> None:
    """Neither names its run, as before `make headline` wrote both; or both name the same, and the README tells which."""
    facts = headline.facts_of(headline.load(HEADLINE))
    named = {name: facts[name] for name in ("run", "commit", "date") if name in facts}
    about = json.loads(ABOUT.read_text(encoding="utf-8")) if ABOUT.exists() else {"pictures": []}
    assert {name: about[name] for name in ("run", "commit", "date") if name in about} == named
    readme = README.read_text(encoding="utf-8")
    assert all(text[: headline.SHORT_COMMIT if name == "commit" else None] in readme for name, text in named.items())
    if named:
        paths = [Path(path) for path in re.findall(r"!\[[^\]]+\]\(([^)]+)\)", readme)]
        shown = {path.name for path in paths if path.parent == Path("reports/pictures")}
        assert shown == set(about["pictures"]) == {path.name for path in ABOUT.parent.iterdir()} - {ABOUT.name}


def test_what_a_run_did_not_keep_is_said(run_dir: Write, results: Json) -> None:
    provenance: Json = {"started": "2026-11-24T09:29:45+00:00", "commit": 40 * "a"}
    assert headline.origin(load(run_dir(results)), "r1") == {"run": "r1", "commit": "unknown", "date": "unknown"}
    told = headline.origin(load(run_dir(results | {"provenance": provenance})), "r2")
    assert told == {"run": "r2", "commit": 40 * "a", "date": "2026-11-24"}
    without: Json = {"started": None, "commit": None}
    assert headline.origin(load(run_dir(results | {"provenance": without})), "r3")["commit"] == "unknown"


def test_from_a_run_to_words(run_dir: Write, results: Json, tmp_path: Path) -> None:
    path = tmp_path / "headline.csv"
    path.write_text(headline.numbers(load(run_dir(results))))
    words = headline.block(headline.load(path))
    assert words.startswith("Measured on some cores of Abacus 9, Python 3.11.\n")
    assert "| arm_wall | overlap | **300 nm** | 4.00 mm | 60.0 µm | 10.0 µm | 100 mm |" in words
    assert "|  | frame time | **31.0 µs** | 190 µs | 420 µs | 880 µs | — |" in words
    # ours loses here, and a run that crashed has no number
    assert "| ball_drop | error to closed form | 0.3 | — | — | **0.02** | — |" in words


def test_rooms_of_unseen_motions_are_one_row_with_the_worst_of_each_run(run_dir: Write, results: Json, tmp_path: Path) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    drawn = [
        rows[0] | {"scenario": f"unseen_{room}", "engine": engine, "preset": "default", "metric": "chatter_frames",
                   "value": value, "unit": "%", "bound": None, "ceiling": None, "status": "info", "note": ""}
        for room, ours, theirs in (("floor", 3.0, 1.0), ("wall", 9.0, 0.5))
        for engine, value in (("avatarsim", ours), ("mujoco", theirs))
    ]
    path = tmp_path / "headline.csv"
    path.write_text(headline.numbers(load(run_dir(results | {"rows": [*rows, *drawn]}))))
    (line,) = [line for line in headline.block(headline.load(path)).splitlines() if "not tuned for" in line]
    assert line.startswith("| motion not tuned for, worst of 2 rooms | frames in contact that shake | 9.00 % |")
    assert "| **1.00 %** |" in line


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
    assert engine < words.index("|  | as called from Python, 3 x 200 frames | 35.5 µs | 210 µs |")


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


def test_a_run_that_has_a_name_is_told_before_its_table(run_dir: Write, results: Json, tmp_path: Path) -> None:
    provenance: Json = {"started": "2026-11-24T09:29:45+00:00", "commit": "0123456789abcdef"}
    path = tmp_path / "headline.csv"
    path.write_text(headline.numbers(load(run_dir(results | {"provenance": provenance})), "20261124-092945-compare"))
    figures = headline.load(path)
    assert headline.told(figures) == (
        "Table and pictures are of one run, `20261124-092945-compare`, at commit `0123456789ab`, on 2026-11-24.\n\n"
        + headline.block(figures))
    path.write_text(headline.numbers(load(run_dir(results))))
    assert headline.told(headline.load(path)) == headline.block(headline.load(path))
