"""`import avatarsim as av`: its names, that each has a docstring, and that the example of its page runs."""

import ast
import doctest
import subprocess
import sys
from pathlib import Path

import pytest

import avatarsim as av

SOURCE = Path(str(av.__file__))
NAMES = [name for name in av.__all__ if name != "__version__"]


def declared() -> set[str]:
    """Return the names that a type checker sees."""
    tree = ast.parse(SOURCE.read_text(encoding="utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING")
    return {f"{node.module}.{alias.name}" for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names}


def test_a_type_checker_knows_the_same_names() -> None:
    assert 25 <= len(NAMES) <= 60 and list(av.__all__) == sorted(av.__all__)
    assert declared() == {f"{module}.{name}" for name, module in av._MODULE_OF.items()}
    assert set(NAMES) == set(av._MODULE_OF) <= set(dir(av))


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_that_of_what_it_stands_for(name: str) -> None:
    assert getattr(av, name).__name__ == name


def test_the_example_of_the_page_runs() -> None:
    found = doctest.testmod(av)
    assert found.attempted >= 8 and found.failed == 0


def test_a_misspelt_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'avatarsim' has no attribute 'Scenes'"):
        av.Scenes  # type: ignore[attr-defined]  # noqa: B018


def test_descriptions_of_scenes_load_no_compiler() -> None:
    code = "import sys, avatarsim as av; av.Scene; av.rest; av.pieces_of_mesh; av.Settings; print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], cwd=SOURCE.parents[1], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
