"""Settings of a user's own: help, the page of commands and the example file say the same; every engine takes the example."""

import re
import tomllib
from pathlib import Path

import pytest

from scenarios.__main__ import parser
from scenarios.engines import known
from scenarios.run.own_settings import EXAMPLE, check_settings, read
from tests.agreement.rivals import needs_pybullet

ROOT = Path(__file__).resolve().parents[3]
FILE = ROOT / EXAMPLE
PAGE = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")


def test_the_example_has_a_row_for_each_engine_that_has_settings() -> None:
    rows = read(FILE, known())
    assert [row.engine for row in rows] == ["avatarsim", "mujoco", "pybullet"]
    assert all(row.options and "preset" not in row.options for row in rows)
    assert {row.base for row in rows} == {"default", "tuned"}


@needs_pybullet
def test_every_engine_takes_the_example_as_it_is() -> None:
    check_settings(read(FILE, known()), "ball_drop", FILE, 0)


def test_the_page_of_commands_shows_a_part_of_the_example() -> None:
    [shown] = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    text = FILE.read_text(encoding="utf-8")
    assert shown in text
    whole = tomllib.loads(text)
    assert tomllib.loads(shown).items() <= whole.items()


def test_help_and_page_name_the_example_and_the_form_of_its_tables(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        parser().parse_args(["run", "--help"])
    helped = " ".join(capsys.readouterr().out.split())
    for said in (helped, PAGE):
        assert EXAMPLE in said and "[engine.name]" in said and "--settings FILE.toml" in said
