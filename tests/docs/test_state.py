"""The page of state lists what frames keep, and the docstring of each type in there says something of each of its fields."""

import ast
import inspect
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from avatarsim.snapshot import kept_by
from tests.test_snapshot import cases

PAGE = (Path(__file__).parents[2] / "docs" / "state.md").read_text(encoding="utf-8")
WHOLE = {"poses", "velocities", "posture"}
"""Fields that the page lists as one."""
PARTS = ("World", "Target", "IkLoop", "SimulatedLoop", "PaperLoop")
NAMES = ("a heap", "a path", "thrown about, method paper")
"""Scenes in which together every part occurs."""


def listed() -> dict[str, set[str]]:
    """Fields that the page has, by part."""
    found = {}
    for text, after in pairwise([*re.finditer(r"^## (\w+)$|\Z", PAGE, re.MULTILINE)]):
        found[text[1]] = set(re.findall(r"^\| `([\w.]+)` \|", PAGE[text.end() : after.start()], re.MULTILINE))
    return found


def kept(name: str) -> Iterator[tuple[object, list[str]]]:
    """(part, names along the way to an array that it keeps) of a scene."""
    parts = {type(part).__name__: part for part in cases()[name].engine()._running().parts()}
    for field in kept_by(list(parts.values())):
        part, *names = field.name.split(".")
        yield parts[part], names


def documented(kind: type) -> set[str]:
    """Words of the docstring of a type, and its fields that have a docstring of their own."""
    (tree,) = ast.parse(inspect.getsource(kind)).body
    assert isinstance(tree, ast.ClassDef)
    own = {
        node.target.id for node, said in pairwise(tree.body)
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and isinstance(said, ast.Expr)
    }
    return own | set(re.findall(r"\w+", ast.get_docstring(tree) or ""))


def test_the_page_lists_what_frames_keep_and_nothing_else() -> None:
    found: dict[str, set[str]] = {part: set() for part in PARTS}
    for name in NAMES:
        for part, names in kept(name):
            found[type(part).__name__].add(names[0] if names[0] in WHOLE else ".".join(names[:2]))
    assert found == listed()


@pytest.mark.parametrize("name", NAMES)
def test_each_kept_field_is_named_where_its_type_is_defined(name: str) -> None:
    silent = set()
    for part, names in kept(name):
        value = getattr(part, names[0])
        for field in names[1:]:
            # a table of records is known by its type, of which only the columns are
            if field not in documented(type(value)):
                silent.add(f"{type(value).__name__}.{field}")
            value = getattr(value, field)
    assert silent == set()
