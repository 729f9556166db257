"""Recipes of the Makefile, run with a stand-in for Python that writes down what it is called with."""

import shutil
import subprocess
from pathlib import Path

import pytest

MAKEFILE = Path(__file__).parents[2] / "Makefile"
STAND_IN = """#!/bin/sh
echo "$*" >> calls
"""


def calls(folder: Path, *words: str) -> list[str]:
    """What `make` calls Python with in a folder that is set up, with the runs that are in it."""
    shutil.copy(MAKEFILE, folder)
    python = folder / ".venv" / "bin" / "python"
    for path in (python, *(folder / name for name in ("requirements.lock", "pyproject.toml", ".setup/choose_python.py",
                                                      ".setup/install.py", ".venv/set-up-stamp"))):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(STAND_IN)
    python.chmod(0o755)
    make = shutil.which("make")
    assert make is not None
    subprocess.run([make, "-s", "-C", str(folder), *words], check=True, capture_output=True)
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
def test_the_report_that_is_written_is_that_of_the_comparison_where_there_is_one(tmp_path: Path, compared: bool) -> None:
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
