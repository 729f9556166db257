"""The commands of reports: exit codes, files, and an error in one sentence for what cannot be read."""

import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from reports.__main__ import main
from runfiles.table import Row
from scenarios.job import Job, Outcome
from scenarios.run.results import Results, write
from tests.reports.pages.conftest import filled
from tests.reports.small_runs import HOST, OVERLAP

Json = dict[str, object]
Write = Callable[[object], Path]
Output = pytest.CaptureFixture[str]
ROOT = Path(__file__).parents[2]
PAGES = {"index.html", "method.html", "engines.html", "glossary.html", "summary.md", "junit.xml"}


def worse_run(results: Json) -> Json:
    """The run with our overlap in the first scene grown."""
    rows = results["rows"]
    assert isinstance(rows, list)
    return results | {"rows": [{**rows[0], "value": 1e-3}, *rows[1:]]}


def test_write_makes_the_report_from_the_results_alone(run_dir: Write, results: Json, capsys: Output) -> None:
    folder = run_dir(results)
    assert main(["write", str(folder)]) == 0
    assert Path(capsys.readouterr().out.strip()) == folder / "index.html"
    assert {path.name for path in folder.iterdir()} == {"results.json", "scenes"} | PAGES


def test_a_damaged_part_is_named_and_the_exit_code_is_2(tmp_path: Path, capsys: Output) -> None:
    folder = filled(tmp_path / "run")
    (folder / "settings.csv").write_bytes(b"\xff\xfe\x00")
    assert main(["write", str(folder)]) == 2
    assert "settings.csv" in capsys.readouterr().err and (folder / "index.html").exists()


@pytest.mark.parametrize(
    "content", [None, b"", b'{"rows": [', b"\xff\xfe\x00\x01", "a file in place of the folder", "an empty folder"]
)
@pytest.mark.parametrize("words", [["write"], ["diff"], ["baseline", "--to", "kept.csv"], ["headline"]])
def test_an_error_names_a_folder_that_is_no_run(
    tmp_path: Path, content: bytes | str | None, words: Sequence[str], capsys: Output, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    place = tmp_path / "place"
    if content == "a file in place of the folder":
        place.write_text("x")
    elif content is not None:
        place.mkdir()
    if isinstance(content, bytes):
        (place / "results.json").write_bytes(content)
    before = sorted(tmp_path.rglob("*"))
    places = [str(place)] * (2 if words[0] == "diff" else 1)
    assert main([words[0], *places, *words[1:]]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and str(place) in printed.err and "Traceback" not in printed.err
    assert sorted(tmp_path.rglob("*")) == before


def test_diff_fails_only_when_something_got_worse(run_dir: Write, results: Json, capsys: Output) -> None:
    old, worse = run_dir(results), run_dir(worse_run(results))
    assert main(["diff", str(old), str(old)]) == 0
    assert main(["diff", str(worse), str(old)]) == 0
    capsys.readouterr()
    assert main(["diff", str(old), str(worse)]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert sum(OVERLAP in line and "arm_wall" in line for line in lines) == 1


def test_diff_takes_a_baseline_too(run_dir: Write, results: Json, tmp_path: Path) -> None:
    kept = tmp_path / "kept.csv"
    assert main(["baseline", str(run_dir(results)), "--to", str(kept)]) == 0
    assert main(["diff", str(kept), str(run_dir(results))]) == 0
    assert main(["diff", str(kept), str(run_dir(worse_run(results)))]) == 1
    kept.write_bytes(b"\xff\xfe\x00\x01")
    assert main(["diff", str(kept), str(run_dir(results))]) == 2


@pytest.mark.parametrize("words", [[], ["nothing"], ["write", "--no-such-option"], ["diff"]])
def test_wrong_usage_is_exit_code_2(words: Sequence[str]) -> None:
    with pytest.raises(SystemExit) as error:
        main(words)
    assert error.value.code == 2


def timed_run(folder: Path, times: Sequence[float]) -> Path:
    """A run of one scene, as the harness writes it, with these frame times [us]."""
    figures = {f"frame_time_{name}": float(np.percentile(times, at)) for name, at in (("p50", 50), ("p95", 95), ("max", 100))}
    rows = [Row("drop", "avatarsim", "default", 0, len(times), OVERLAP, 1e-7, "m", 1e-6, None, "pass")]
    rows += [
        Row("drop", "avatarsim", "default", 0, len(times), metric, value, "us", None, None, "info")
        for metric, value in figures.items()
    ]
    series = {"drop": {"avatarsim/default": {"overlap_m": [0.0], "frame_time_us": list(times)}}}
    folder.mkdir()
    outcome = Outcome(Job("drop", "avatarsim", "default"), "measured")
    write(Results(rows, [outcome], series, {"drop": {"title": "A drop."}}, HOST, 0), folder)
    return folder


@pytest.mark.parametrize("factor", [1.0, 3.0])
def test_as_a_command_noise_is_nothing_and_a_slow_run_is_worse(tmp_path: Path, factor: float) -> None:
    draw = np.random.default_rng(3)
    old, new = (30.0 * draw.gamma(16.0, 1 / 16.0, 400) for _ in range(2))
    new[200] = 4.0 * old.max()
    folders = timed_run(tmp_path / "old", old.tolist()), timed_run(tmp_path / "new", (factor * new).tolist())
    found = subprocess.run(
        [sys.executable, "-m", "reports", "diff", *map(str, folders)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    named = {metric for metric in ("frame_time_p50", "frame_time_p95", "frame_time_max") if metric in found.stdout}
    assert (found.returncode, found.stderr) == (int(factor > 1.0), "")
    assert named == ({"frame_time_p50", "frame_time_p95"} if factor > 1.0 else set())
