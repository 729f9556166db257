"""Recipes of the Makefile: calls of Python, recorded by a fake interpreter, and the runs that `make prune` removes."""

import shutil
import subprocess
from pathlib import Path

import pytest

MAKEFILE = Path(__file__).parents[2] / "Makefile"
MAKE = shutil.which("make") or "make"
STAND_IN = """#!/bin/sh
echo "$*" >> calls
"""
OLD, LAST, RUNNING = "20250101-120000-compare", "20250102-080000-compare", "20250102-080000-compare-1"
OLD_CHECK, LAST_CHECK = "20250101-130000-check", "20250103-080000-check"
BENCH = "20250101-140000-bench"
OTHERS = {"stability", "found", "notes.csv"}
"""Names that are not runs."""


def calls(folder: Path, *words: str) -> list[str]:
    """Return the arguments of each call of Python by `make` in a set-up folder with its runs."""
    shutil.copy(MAKEFILE, folder)
    python = folder / ".venv" / "bin" / "python"
    for path in (python, *(folder / name for name in ("requirements.lock", "pyproject.toml", ".setup/choose_python.py",
                                                      ".setup/install.py", ".venv/set-up-stamp"))):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(STAND_IN)
    python.chmod(0o755)
    subprocess.run([MAKE, "-s", "-C", str(folder), *words], check=True, capture_output=True)
    return (folder / "calls").read_text().splitlines()


def a_run(folder: Path, *links: str) -> None:
    run = folder / "reports" / "out" / "20250101-120000-any"
    run.mkdir(parents=True)
    (run / "results.json").write_text("{}")
    for link in links:
        (run.parent / link).symlink_to(run.name)


def test_the_gate_reads_its_own_run(tmp_path: Path) -> None:
    a_run(tmp_path, "latest", "latest-check")
    assert calls(tmp_path, "check")[-1] == "-m reports diff reports/baseline.csv reports/out/latest-check"


@pytest.mark.parametrize("compared", [True, False])
def test_the_report_is_that_of_the_comparison(tmp_path: Path, compared: bool) -> None:
    a_run(tmp_path, *(("latest",) if compared else ()), "latest-bench", "latest-check")
    written = [call for call in calls(tmp_path, "bench") if call.startswith("-m reports write")]
    assert written[-1] == f"-m reports write reports/out/latest{'' if compared else '-bench'}"


def test_the_parts_of_bench_go_into_one_report(tmp_path: Path) -> None:
    a_run(tmp_path, "latest-bench")
    found = [call for call in calls(tmp_path, "bench") if "benchmarks " in call]
    assert len(found) == 4 and all(call.endswith(" reports/out/latest-bench") for call in found)


def test_without_a_comparison_no_report_is_written(tmp_path: Path) -> None:
    a_run(tmp_path, "latest-check")
    assert not [call for call in calls(tmp_path, "study") if call.startswith("-m reports")]


def pruned(folder: Path) -> set[str]:
    """Run `make prune` in a project and return the names left in `reports/out`."""
    recipe = MAKEFILE.read_text(encoding="utf-8")
    recipe = recipe[recipe.index("prune:") :].split("\n\n")[0]
    (folder / "Makefile").write_text(f"{recipe}\n", encoding="utf-8")
    done = subprocess.run([MAKE, "-s", "-C", str(folder), "prune"], capture_output=True, text=True, check=True)
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
