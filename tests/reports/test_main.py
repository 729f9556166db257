"""The commands of reports: exit codes, files, and an error in one sentence for unreadable input."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from reports.__main__ import main
from tests.reports.pages.conftest import filled
from tests.reports.small_runs import OVERLAP

Json = dict[str, object]
Write = Callable[[object], Path]
Output = pytest.CaptureFixture[str]
PAGES = {"index.html", "method.html", "engines.html", "glossary.html", "summary.md", "junit.xml"}


def worse_run(results: Json) -> Json:
    """Return the run with a larger overlap of our engine in the first scene."""
    rows = results["rows"]
    assert isinstance(rows, list)
    return results | {"rows": [{**rows[0], "value": 1e-3}, *rows[1:]]}


def test_write_makes_the_report_from_the_results_alone(run_dir: Write, results: Json, capsys: Output) -> None:
    folder = run_dir(results)
    assert main(["write", str(folder)]) == 0
    assert Path(capsys.readouterr().out.splitlines()[-1]) == folder / "index.html"
    assert {path.name for path in folder.iterdir()} == {"results.json", "scenes", "lib"} | PAGES


def test_write_compares_with_the_run_before(run_dir: Write, results: Json, tmp_path: Path, capsys: Output) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    worse = runs / "20260103-100000-compare"
    for name, content in (("20260101-100000-compare", worse_run(results)), ("20260102-090000-compare", results),
                          ("20260102-100000-bench", worse_run(results)), (worse.name, worse_run(results))):
        run_dir(content).rename(runs / name)
    latest = runs / "latest"
    latest.symlink_to(worse.name)
    for path in (worse, latest):
        assert main(["write", str(path)]) == 0
        for told in (capsys.readouterr().out, (worse / "summary.md").read_text()):
            assert "20260102-090000-compare" in told and "20260101" not in told


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


def test_diff_fails_only_when_something_got_worse(run_dir: Write, results: Json, tmp_path: Path, capsys: Output) -> None:
    kept, old, worse = tmp_path / "kept.csv", run_dir(results), run_dir(worse_run(results))
    assert main(["baseline", str(old), "--to", str(kept)]) == 0
    for base, new, code in ((old, old, 0), (worse, old, 0), (old, worse, 1), (kept, old, 0), (kept, worse, 1)):
        capsys.readouterr()
        assert main(["diff", str(base), str(new)]) == code
        lines = capsys.readouterr().out.splitlines()
        assert sum(OVERLAP in line and "arm_wall" in line for line in lines) == (code or base == worse)
    kept.write_bytes(b"\xff\xfe\x00\x01")
    assert main(["diff", str(kept), str(old)]) == 2


def test_a_place_that_takes_no_file_is_a_sentence(run_dir: Write, results: Json, capsys: Output) -> None:
    assert main(["baseline", str(run_dir(results)), "--to", "a" * 5000]) == 2
    assert "aaa" in capsys.readouterr().err


@pytest.mark.parametrize("words", [[], ["nothing"], ["write", "--no-such-option"], ["diff"]])
def test_wrong_usage_is_exit_code_2(words: Sequence[str]) -> None:
    with pytest.raises(SystemExit) as error:
        main(words)
    assert error.value.code == 2
