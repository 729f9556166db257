"""`docs/equations.md`: each equation of the paper with functions that exist and name it in their docstrings, and its tests."""

import ast
import re
from pathlib import Path

import pytest

from tests.paper.claims import EQUATIONS

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
SECTIONS = {int(n): text for n, text in re.findall(r"^## Equation (\d+):(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE)}
NAMED = re.compile(r"`(avatarsim(?:\.\w+)+)`")
SAID = re.compile(r"\b[Ee]q(?:s|uations?)?\b\.?\s*((?:\(?\d+\)?(?:\s*(?:,|to|and)\s*)?)+)")
"""An equation by number, or several: "eq. 1", "Eq. (4)", "eqs 7 to 10", "Equations 7, 9 and 10"."""


def numbers_in(text: str) -> set[int]:
    """Numbers of all equations that a text names."""
    found: set[int] = set()
    for said in SAID.findall(text):
        for low, high in re.findall(r"(\d+)\)?\s+to\s+\(?(\d+)", said):
            found |= set(range(int(low), int(high) + 1))
        found |= {int(n) for n in re.findall(r"\d+", said)}
    return found


def function(dotted: str) -> ast.FunctionDef:
    """The definition of a function by its full name; an AssertionError says what is not there."""
    module, _, name = dotted.rpartition(".")
    file = ROOT / (module.replace(".", "/") + ".py")
    assert file.is_file(), f"{dotted}: no {file.relative_to(ROOT)}"
    found = [n for n in ast.parse(file.read_text(encoding="utf-8")).body if isinstance(n, ast.FunctionDef) and n.name == name]
    assert found, f"{dotted}: no function {name} in {file.relative_to(ROOT)}"
    return found[0]


def test_all_ten_are_there_in_order() -> None:
    assert list(SECTIONS) == list(range(1, 11)) and len(EQUATIONS) == 10


@pytest.mark.parametrize("number", SECTIONS)
def test_its_functions_exist_and_name_it(number: int) -> None:
    named = NAMED.findall(SECTIONS[number])
    assert named
    for dotted in named:
        said = numbers_in(ast.get_docstring(function(dotted)) or "")
        assert number in said, f"{dotted} names equations {sorted(said)}"


@pytest.mark.parametrize("number", SECTIONS)
def test_its_functions_stand_in_the_files_that_are_linked(number: int) -> None:
    text = SECTIONS[number]
    linked = set(re.findall(r"\]\(\.\./(avatarsim/\S+?\.py)\)", text))
    first = NAMED.findall(text)[0]
    assert linked == {first.rpartition(".")[0].replace(".", "/") + ".py"}


@pytest.mark.parametrize("number", SECTIONS)
def test_its_tests_are_those_that_the_claims_name(number: int) -> None:
    (file,) = re.findall(r"- Tests: \[(tests/\S+)\]\(\.\./\1\)", SECTIONS[number])
    assert (ROOT / file).is_file()
    assert file in {f"tests/{entry.partition('::')[0]}" for entry in EQUATIONS[f"equation {number}"].tests}


@pytest.mark.parametrize("number", SECTIONS)
def test_it_has_a_formula(number: int) -> None:
    assert SECTIONS[number].count("$$") == 2


def test_numbers_are_read_from_prose() -> None:
    assert numbers_in("Eq. (4): p', by eqs 7 to 10, and Equations 1, 2 and 3; eq. 1/2.") == {1, 2, 3, 4, 7, 8, 9, 10}
    assert numbers_in("equal 5, seq. 6, equations of motion") == set()
