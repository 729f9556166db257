"""A damaged file removes only its scene or section, and is named; the rest of the report is complete."""

from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from reports.pages import articles
from runfiles import array_file
from tests.reports.pages.conftest import filled
from tests.reports.pages.reading import data_of, read
from tests.reports.small_runs import OURS

RECORDING = f"recordings/arm_wall.{OURS.replace('/', '.')}.0.npz"
TABLES = ("settings.csv", "hard_cases.csv", "effects.csv", "growth.csv")
PAGES = {"index.html", "method.html", "engines.html", "glossary.html"}


def spoil(path: Path, how: str) -> None:
    """Cut a file in half, empty it, or replace it."""
    content = path.read_bytes()
    path.write_bytes({"cut": content[: len(content) // 2], "empty": b"", "other": b"\x00\xff\xfe{}" * 9}[how])


def pages_of(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*.html")}


@pytest.mark.parametrize("how", ["cut", "empty", "other"])
@pytest.mark.parametrize(("name", "stem"), [
    (RECORDING, "arm_wall"), ("scenes/arm_wall.json", "arm_wall"), ("overlaps/arm_wall.mujoco.tuned.0.npz", "mujoco/tuned"),
])
def test_damaged_files_are_named_and_all_pages_are_there(tmp_path: Path, name: str, stem: str, how: str) -> None:
    """A file of a scene and all tables are damaged in the same way."""
    folder = filled(tmp_path / "run")
    for one in (name, *TABLES):
        spoil(folder / one, how)
    damage = write_report(folder)
    assert PAGES <= {path.name for path in folder.glob("*.html")} and len(list(folder.glob("scenes/*.html"))) == 3
    # half a table may still be a valid table
    for words in ((stem, Path(name).name), *((table,) for table in TABLES[:3] if how != "cut")):
        assert any(word in said for word in words for said in damage), words
    shown = read(folder / "index.html").text
    assert all(said.split()[0] in shown for said in damage) and str(tmp_path) not in " ".join(damage)


@pytest.mark.parametrize("place", ["positions", "orientations", "times", "velocities"])
@pytest.mark.parametrize("value", [np.nan, np.inf, 1e30])
def test_a_recording_that_diverges_is_shown_or_named(tmp_path: Path, place: str, value: float) -> None:
    folder = filled(tmp_path / "run")
    arrays = array_file.read(folder / RECORDING)
    arrays[place][5:] = value
    with (folder / RECORDING).open("wb") as file:
        array_file.write(file, arrays)
    damage = write_report(folder)
    assert damage if place == "times" and value != 1e30 else True
    assert data_of(folder / "scenes" / "arm_wall.html")


@pytest.mark.parametrize("content", ["", "{", "[]", '{"schema_version": 99, "rows": []}'])
def test_without_results_a_report_stays_as_it_was(tmp_path: Path, content: str) -> None:
    folder = filled(tmp_path / "run")
    write_report(folder)
    before = pages_of(folder)
    (folder / "results.json").write_text(content, encoding="utf-8")
    with pytest.raises(InvalidFile, match=r"results\.json"):
        write_report(folder)
    assert pages_of(folder) == before


def test_a_page_that_cannot_be_made_leaves_the_folder_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = filled(tmp_path / "run")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    def broken(run: object) -> dict[str, str]:
        raise RuntimeError("a page cannot be made")

    # the pages of scenes are made before this one
    monkeypatch.setattr(articles, "articles", broken)
    with pytest.raises(RuntimeError, match="a page"):
        write_report(folder)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def test_an_earlier_run_that_cannot_be_read_is_left_out(tmp_path: Path) -> None:
    folder, earlier = filled(tmp_path / "run"), filled(tmp_path / "earlier")
    (earlier / "results.json").write_text("{}", encoding="utf-8")
    write_report(folder, earlier)
    assert "changes" not in read(folder / "index.html").ids
    first = pages_of(folder)
    write_report(folder)
    assert pages_of(folder) == first
