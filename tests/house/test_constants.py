"""The tuned constants of the engine: how many there may be, and how they are told from others."""

import ast
import re
from pathlib import Path

import pytest

from tests.house.constants import DERIVED, STRUCTURE, TUNED, inventory, main, numbers_of, unknown

COMMANDS = Path(__file__).resolve().parents[2] / "docs" / "commands.md"


def test_there_are_as_many_as_the_page_says(capsys: pytest.CaptureFixture[str]) -> None:
    said = re.search(r"There are (\d+)\. What is computed from others", COMMANDS.read_text(encoding="utf-8"))
    assert said, "docs/commands.md does not say how many there are"
    tuned = [one for one in inventory() if one.kind == TUNED]
    assert len(tuned) <= int(said[1])
    assert main([]) == 0
    *lines, last = capsys.readouterr().out.splitlines()
    assert len(lines) == len(tuned) and last.startswith(f"{len(tuned)} tuned, ")


def test_what_is_listed_as_not_tuned_is_there() -> None:
    assert unknown() == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("STEP = 0.1", [("STEP", TUNED)]),
        ("STEP, MOST = 1e-3, 4", [("STEP", TUNED), ("MOST", TUNED)]),
        ("STEP: Final = 1.0 / 3.0", [("STEP", TUNED)]),
        ("TWICE = 2.0 * STEP", [("TWICE", DERIVED)]),
        ("SAME = STEP", [("SAME", DERIVED)]),
        ("CODE = 3", [("CODE", STRUCTURE)]),
        ("HASTY = Care(tolerance=1e-6, first=60)", [("HASTY.tolerance", TUNED), ("HASTY.first", TUNED)]),
        ("NAME = 'a'", []),
        ("IS_ON = True", []),
        ("class S(NamedTuple):\n    rate: float = 30.0", [("rate", TUNED)]),
        ("def f(x):\n    return 0.7 * x", [("f()", TUNED)]),
        ("def f(x):\n    return 0.25 * x + 12.0 if x > 1e-300 else x", []),
    ],
)
def test_kinds_of_numbers(text: str, found: list[tuple[str, str]]) -> None:
    assert [(name, kind) for name, kind, _ in numbers_of(ast.parse(text), {"CODE": STRUCTURE})] == found
