"""The page on cleaning files: its commands and options exist, its exit codes are those of the command, and its Python runs."""

import re
import shlex
from pathlib import Path

import pytest

from avatarsim.cli import motions
from avatarsim.cli.arguments import parsed, parser
from avatarsim.console import FAULT, USAGE
from tests.clips.made import bvh

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "clean.md").read_text(encoding="utf-8")
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_options_on_the_page_exist_and_none_is_left_out() -> None:
    named = set(re.findall(r"`(--[a-z-]+)", PAGE))
    commands = next(action for action in parser()._subparsers._group_actions)  # type: ignore[union-attr]
    clean = commands.choices["clean"]  # type: ignore[index]
    known = {word for action in clean._actions for word in action.option_strings}
    assert named <= known
    assert {word for word in known if word.startswith("--")} - named <= {"--help", "--out", "--workers"}


def test_commands_on_the_page_and_in_the_readme_are_understood() -> None:
    lines = re.findall(r"(?:^|&& )avatarsim (clean [^`\n]*?)(?:  #.*|`.*)?$", PAGE + README, re.MULTILINE)
    assert len(lines) >= 2
    for line in lines:
        assert parsed(shlex.split(line)).command == "clean"


def test_exit_codes_are_those_of_the_command() -> None:
    [table] = re.findall(r"^## Exit codes\n.*?(^\|.*?)\n\n", PAGE, re.DOTALL | re.MULTILINE)
    codes = {int(code) for code in re.findall(r"^\| (\d+) \|", table, re.MULTILINE)}
    assert codes == {motions.CLEAN, motions.LEFT, USAGE, motions.UNDONE, motions.STOPPED, FAULT}


def test_the_python_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    bvh(tmp_path / "walk.bvh")
    exec(code, {})
    depth, rest = capsys.readouterr().out.splitlines()
    assert float(depth) > 0.05 and rest.startswith("True [(") and (tmp_path / "cleaned.bvh").stat().st_size > 1000
