"""The two commands, their exit codes and what they print."""

import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from reports.__main__ import main
from scenarios.job import Job, Outcome
from scenarios.results.results import Results, Row, write

Json = dict[str, object]
Write = Callable[[object], Path]
ROOT = Path(__file__).parents[2]
HOST = {"cpu": "Abacus 9", "cpus": 2, "platform": "Linux", "python": "3.11"}


def test_write_prints_where_the_page_is(run_dir: Write, results: Json, capsys: pytest.CaptureFixture[str]) -> None:
    folder = run_dir(results)
    assert main(["write", str(folder)]) == 0
    assert Path(capsys.readouterr().out.strip()) == folder / "index.html"
    assert {path.name for path in folder.iterdir()} == {"results.json", "index.html", "summary.md", "junit.xml", "scenes"}


def test_a_folder_without_results_is_a_usage_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["write", str(tmp_path)]) == 2
    assert "results.json" in capsys.readouterr().err


def test_diff_fails_only_when_something_got_worse(run_dir: Write, results: Json, capsys: pytest.CaptureFixture[str]) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    old, worse = run_dir(results), run_dir(results | {"rows": [rows[0] | {"value": 1e-3}, *rows[1:]]})
    assert main(["diff", str(old), str(old)]) == 0
    assert main(["diff", str(old), str(worse)]) == 1
    assert main(["diff", str(worse), str(old)]) == 0
    assert "residual_overlap_max: 300 nm -> 1.00 mm" in capsys.readouterr().out
    assert main(["diff", str(old), str(old.parent)]) == 2


def timed_run(folder: Path, times: Sequence[float]) -> Path:
    """A run of one scene, as the harness writes it, with these frame times [us]."""
    p50, p95, most = (float(time) for time in np.percentile(times, (50, 95, 100)))
    figures = {"frame_time_p50": p50, "frame_time_p95": p95, "frame_time_max": most, "frame_time_python_p50": 1.1 * p50}
    rows = [Row("drop", "avatarsim", "default", 0, len(times), "residual_overlap_max", 1e-7, "m", 1e-6, None, "pass")]
    rows += [Row("drop", "avatarsim", "default", 0, len(times), metric, value, "us", None, None, "info")
             for metric, value in figures.items()]
    series = {"drop": {"avatarsim/default": {"overlap_m": [0.0], "frame_time_us": list(times)}}}
    folder.mkdir()
    outcome = Outcome(Job("drop", "avatarsim", "default"), "measured")
    write(Results(rows, [outcome], series, {"drop": {"title": "A drop."}}, HOST, 0), folder)
    return folder


def diffed(old: Path, new: Path) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([sys.executable, "-m", "reports", "diff", str(old), str(new)], cwd=ROOT, capture_output=True, text=True,
                          check=False)


def test_two_runs_with_noisy_times_differ_in_nothing(tmp_path: Path) -> None:
    """The slowest frame of the second run takes four times as long as the first one's, and the rest is noise."""
    draw = np.random.default_rng(3)
    old, new = (30.0 * draw.gamma(16.0, 1 / 16.0, 400) for _ in range(2))
    new[200] = 4.0 * old.max()
    found = diffed(timed_run(tmp_path / "old", old.tolist()), timed_run(tmp_path / "new", new.tolist()))
    assert (found.returncode, found.stderr) == (0, "")
    assert found.stdout.splitlines()[0] == "worse 0, better 0"


def test_a_run_that_is_slower_in_every_frame_is_worse_in_every_time(tmp_path: Path) -> None:
    draw = np.random.default_rng(3)
    old, new = (30.0 * draw.gamma(16.0, 1 / 16.0, 400) for _ in range(2))
    found = diffed(timed_run(tmp_path / "old", old.tolist()), timed_run(tmp_path / "new", (3.0 * new).tolist()))
    worse = [line.split()[3].strip(":") for line in found.stdout.splitlines()[1:]]
    assert found.returncode == 1 and found.stderr == ""
    assert worse == ["frame_time_p50", "frame_time_p95", "frame_time_max", "frame_time_python_p50"]
