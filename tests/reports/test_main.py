"""The two commands, their exit codes and what they print."""

from collections.abc import Callable
from pathlib import Path

import pytest

from reports.__main__ import main

Json = dict[str, object]
Write = Callable[[object], Path]


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
