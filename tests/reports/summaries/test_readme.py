"""The README's section that a run writes: only between its marks."""

from pathlib import Path
from xml.etree import ElementTree

import pytest

from avatarsim.errors import InvalidFile
from reports.charts.strips import STRIPS
from reports.summaries.readme import BEGINS, ENDS, PICTURE, block, origin, picture, write
from reports.tables.run import Run
from runfiles.engines import run_label
from tests.reports.small_runs import BULLET, HOST, MUJOCO, OURS, RAW, figure, run_of


def run() -> Run:
    """Return a run with each metric of the picture."""
    runs = (OURS, MUJOCO, BULLET, RAW)
    rows = [figure("a", one, chart.metric, 0.1 * k) for chart in STRIPS.values() for k, one in enumerate(runs)]
    return run_of(rows, provenance={**HOST, "commit": "0123456789abcdef", "started": "2026-11-28T06:21:06"}, name="some-run")


def test_only_what_is_between_the_marks_changes(tmp_path: Path) -> None:
    readme = tmp_path / "README.md"
    (tmp_path / PICTURE).parent.mkdir(parents=True)
    readme.write_text(f"before µ\n{BEGINS}\nold words\n{ENDS}\nafter\n", encoding="utf-8")
    write(run(), readme)
    text = readme.read_text(encoding="utf-8")
    assert text.startswith(f"before µ\n{BEGINS}") and text.endswith(f"{ENDS}\nafter\n") and "old words" not in text
    write(run(), readme)
    assert readme.read_text(encoding="utf-8") == text and (tmp_path / PICTURE).stat().st_size > 1000


@pytest.mark.parametrize("text", ["", "words", BEGINS, ENDS, f"{ENDS}\n{BEGINS}"])
def test_a_readme_without_marks_is_left_alone(tmp_path: Path, text: str) -> None:
    readme = tmp_path / "README.md"
    readme.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidFile, match=r"README\.md"):
        write(run(), readme)
    assert readme.read_text(encoding="utf-8") == text and not (tmp_path / PICTURE).exists()


def test_figures_are_traceable_to_run_commit_and_day() -> None:
    assert origin(run()) == {"run": "some-run", "commit": "0123456789abcdef", "date": "2026-11-28"}
    text = block(run())
    assert all(word in text for word in ("some-run", "0123456789ab", "2026-11-28", str(PICTURE)))
    assert all(f"| {run_label(one)} |" in text for one in run().runs)
    assert block(run_of([figure("a", OURS, "course_error_max", 0.0)], provenance={})).startswith(BEGINS)
    assert "@" not in picture(run()) and ElementTree.fromstring(picture(run())).tag.endswith("svg")
