"""Links to the last run: `latest` leads to a comparison, `latest-COMMAND` to a run of any other command."""

from pathlib import Path

import pytest

from tests.scenarios.command_line import called


def links(out: Path) -> dict[str, str]:
    return {path.name: path.readlink().name for path in out.glob("latest*")}


@pytest.mark.parametrize("command", ["check", "run", "bench"])
def test_a_command_that_is_no_comparison_leaves_latest_where_it_is(
    tmp_path: Path, command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("reports.write_report", lambda *_: None)
    out, words = tmp_path / "out", ["--filter", "ball_drop", "--engine", "avatarsim", "--preset", "default"]
    called(tmp_path, command, *words, frames=2)
    (only,) = [path.name for path in out.iterdir() if not path.is_symlink()]
    assert links(out) == {f"latest-{command}": only}
    called(tmp_path, "compare", *words, frames=2)
    compared = links(out)["latest"]
    called(tmp_path, command, *words, frames=2)
    found = links(out)
    assert found["latest"] == compared and set(found) == {"latest", f"latest-{command}"}
    assert found[f"latest-{command}"] not in (only, compared)
