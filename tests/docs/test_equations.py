"""`docs/equations.md`: each equation of the paper, and its tests; `test_links` looks for the functions that it names."""

import re
from pathlib import Path

import pytest

from tests.paper.claims import EQUATIONS

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
SECTIONS = {int(n): text for n, text in re.findall(r"^## Equation (\d+):(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE)}


def test_all_ten_are_there_in_order() -> None:
    assert list(SECTIONS) == list(range(1, 11)) and len(EQUATIONS) == 10


@pytest.mark.parametrize("number", SECTIONS)
def test_its_tests_are_those_that_the_claims_name(number: int) -> None:
    (file,) = re.findall(r"- Tests: \[(tests/\S+)\]\(\.\./\1\)", SECTIONS[number])
    assert (ROOT / file).is_file()
    assert file in {f"tests/{entry.partition('::')[0]}" for entry in EQUATIONS[f"equation {number}"].tests}
