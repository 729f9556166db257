"""`make prune` removes runs that are older than the last one of their command, and nothing else."""

import shutil
import subprocess
from pathlib import Path

import pytest

MAKEFILE = Path(__file__).parents[2] / "Makefile"
OLD, LAST, RUNNING = "20250101-120000-compare", "20250102-080000-compare", "20250102-080000-compare-1"
OLD_CHECK, LAST_CHECK = "20250101-130000-check", "20250103-080000-check"
BENCH = "20250101-140000-bench"
OTHERS = {"stability", "found", "notes.csv"}
"""No runs."""


def pruned(folder: Path) -> set[str]:
    """Names left in the `reports/out` of a project."""
    recipe = MAKEFILE.read_text(encoding="utf-8")
    recipe = recipe[recipe.index("prune:") :].split("\n\n")[0]
    (folder / "Makefile").write_text(f"{recipe}\n", encoding="utf-8")
    make = shutil.which("make")
    if make is None:
        pytest.skip("no make")
    done = subprocess.run([make, "-s", "-C", str(folder), "prune"], capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return {path.name for path in (folder / "reports" / "out").iterdir()}


@pytest.mark.parametrize(
    ("runs", "links", "removed"),
    [
        pytest.param([OLD, LAST, RUNNING], {"latest": LAST}, {OLD}, id="older runs"),
        pytest.param([OLD, LAST], {}, set(), id="no last run"),
        pytest.param([OLD, LAST, RUNNING, OLD_CHECK, LAST_CHECK, BENCH], {"latest": LAST, "latest-check": LAST_CHECK},
                     {OLD, OLD_CHECK, BENCH}, id="a last run of each command; one without goes by the comparison"),
        pytest.param([OLD, LAST, OLD_CHECK, LAST_CHECK], {"latest": OLD_CHECK, "latest-check": LAST_CHECK}, {OLD},
                     id="a link to an older run of another command"),
        pytest.param([OLD, OLD_CHECK, LAST_CHECK], {"latest-check": LAST_CHECK}, {OLD_CHECK}, id="no comparison"),
        pytest.param([], {}, set(), id="no runs"),
    ],
)
def test_older_runs_are_removed_and_all_else_stays(
    tmp_path: Path, runs: list[str], links: dict[str, str], removed: set[str]
) -> None:
    out = tmp_path / "reports" / "out"
    for name in (*runs, *OTHERS):
        (out / name / "recordings").mkdir(parents=True)
    for link, run in links.items():
        (out / link).symlink_to(run)
    left = ({*runs} - removed) | OTHERS | {*links}
    assert pruned(tmp_path) == left
    assert pruned(tmp_path) == left


def test_a_folder_in_place_of_the_link_removes_nothing(tmp_path: Path) -> None:
    for name in (OLD, LAST, "latest"):
        (tmp_path / "reports" / "out" / name).mkdir(parents=True)
    assert pruned(tmp_path) == {OLD, LAST, "latest"}
