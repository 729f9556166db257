"""A report of a small run with recordings and each file that other commands add."""

import json
from pathlib import Path

import pytest

from reports import write_report
from tests.reports.conftest import whole_run
from tests.reports.recorded import recording, scene
from tests.reports.small_runs import OURS, write_all


def filled(folder: Path, **change: object) -> Path:
    """Write a run with recordings of two engines in one scene and the files of other commands; return its folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "results.json").write_text(json.dumps(whole_run() | change), encoding="utf-8")
    (folder / "results.csv").write_text("scenario,engine\n", encoding="utf-8")
    scene(folder, "arm_wall")
    for run in (OURS, "mujoco/tuned"):
        recording(folder, "arm_wall", run, sinks=run != OURS)
    write_all(folder)
    return folder


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a report that tests read and do not change."""
    folder = filled(tmp_path_factory.mktemp("run"))
    assert write_report(folder, filled(tmp_path_factory.mktemp("before"))) == ()
    return folder
