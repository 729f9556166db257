"""Which room may import which, what an import costs, and how long a file may be."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests import longest_first

HOUSE = Path(__file__).resolve().parents[2]
ENGINE = HOUSE / "avatarsim"
FILES = sorted(ENGINE.rglob("*.py"))
BROTHERS = ("ik", "rigid")
"""Rooms that do not import one another: only the frame, above them, composes them."""
LONGEST = 500
"""Most lines of an engine file. Longer ones answer more than one question."""
HEAVY = (
    "pandas", "trimesh", "coacd", "mujoco", "pybullet", "coal", "fcl",
    "itables", "jinja2", "gymnasium_robotics", "tqdm", "joblib",
    "scipy.spatial", "scipy.optimize",
)
"""Packages that cost more to import than the engine's first frame, or that the engine is compared with."""

PRIVATE, PRIVATE_LINES = re.compile(r"numba\.core|llvmlite"), 700
"""Private parts of the compiler, and most lines of all files together that name them."""

WRITES = {"ik": ("velocities",), "rigid": ("posture",)}
"""What a room may not write: the posture solver leaves velocities alone, impacts leave joint angles alone."""


def imports(file: Path) -> Iterator[str]:
    """Modules that a file imports, wherever in it."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file.name} imports by dots, which the kernel cache would have to guess"
            yield node.module or ""
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@pytest.mark.parametrize("room", BROTHERS)
def test_brothers_do_not_know_each_other(room: str) -> None:
    for file in sorted((ENGINE / room).glob("*.py")):
        for module in imports(file):
            for brother in BROTHERS:
                assert brother == room or not module.startswith(f"avatarsim.{brother}"), f"{file.name} imports {module}"


@pytest.mark.parametrize("room", ["spatial", "scene", "model", "collision", "planner", "coupling", "paper", *BROTHERS])
def test_no_room_looks_up_to_the_frame_or_out_of_the_house(room: str) -> None:
    assert (ENGINE / room / "__init__.py").exists()
    for file in sorted((ENGINE / room).glob("*.py")):
        for module in imports(file):
            above = "avatarsim.frame", "avatarsim.simulator", "runfiles", "reference", "scenarios", "reports", "tests"
            assert not module.startswith(above)


LAYERS = ("spatial", "scene", "model", "collision")


@pytest.mark.parametrize("room", LAYERS)
def test_lower_rooms_do_not_know_higher_ones(room: str) -> None:
    higher = (*LAYERS[LAYERS.index(room) + 1 :], *BROTHERS)
    for file in sorted((ENGINE / room).glob("*.py")):
        for module in imports(file):
            assert not module.startswith(tuple(f"avatarsim.{name}" for name in higher)), f"{file.name} imports {module}"


@pytest.mark.parametrize("room", sorted(WRITES))
def test_no_room_writes_what_it_may_not(room: str) -> None:
    """No assignment to an element or attribute of a name or field that says it belongs to another room."""
    for file in sorted((ENGINE / room).glob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AugAssign) else []
            for target in targets:
                if isinstance(target, ast.Subscript | ast.Attribute):
                    written = ast.unparse(target).split("[")[0].split(".")
                    assert not set(written) & set(WRITES[room]), f"{file.name} writes {ast.unparse(target)}"


def imported_by(statement: str) -> set[str]:
    """Modules in memory after a statement, in a fresh process. (A little of scipy itself comes with numba.)"""
    script = f"{statement}\nimport sys\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], cwd=HOUSE, capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_private_parts_of_the_compiler_stay_in_one_small_room() -> None:
    named = [file for file in FILES if PRIVATE.search(file.read_text(encoding="utf-8"))]
    assert named and {file.parent for file in named} == {ENGINE / "jit"}
    assert sum(len(file.read_text(encoding="utf-8").splitlines()) for file in named) <= PRIVATE_LINES


def of_the_compiler(tree: ast.Module) -> set[str]:
    """Names that a file has from numba and llvmlite."""
    found = set[str]()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            module = node.module or "" if isinstance(node, ast.ImportFrom) else ""
            found |= {(alias.asname or alias.name).partition(".")[0] for alias in node.names
                      if (module or alias.name).partition(".")[0] in ("numba", "llvmlite")}
    return found


def patches(tree: ast.Module) -> list[int]:
    """Lines that write attributes of what comes from numba or llvmlite."""
    theirs, lines = of_the_compiler(tree), list[int]()
    for node in ast.walk(tree):
        if not isinstance(node, ast.stmt | ast.expr):
            continue
        targets: list[ast.expr] = []
        if isinstance(node, ast.Assign | ast.AugAssign | ast.AnnAssign | ast.Delete):
            targets = node.targets if isinstance(node, ast.Assign | ast.Delete) else [node.target]
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("setattr", "delattr"):
            targets = [ast.Attribute(node.args[0], "")]
        for target in targets:
            base: ast.expr = target
            while isinstance(base, ast.Attribute | ast.Subscript):
                base = base.value
            if base is not target and isinstance(base, ast.Name) and base.id in theirs:
                lines.append(node.lineno)
    return lines


def test_nothing_of_the_compiler_is_patched() -> None:
    assert patches(ast.parse("import numba.core as n\nn.config.X = 1\nsetattr(n, 'a', 2)")) == [2, 3], "patches are found"
    found = [f"{file.relative_to(ENGINE)}:{line}" for file in FILES
             for line in patches(ast.parse(file.read_text(encoding="utf-8")))]
    assert found == []


def test_importing_the_engine_loads_nothing_heavy() -> None:
    loaded = imported_by("import avatarsim.simulator")
    assert "numba" in loaded
    assert not loaded & set(HEAVY)


def test_importing_the_package_loads_no_compiler() -> None:
    assert not imported_by("import avatarsim") & {"numba", "numpy", *HEAVY}


@pytest.mark.parametrize("file", FILES, ids=[str(file.relative_to(ENGINE)) for file in FILES])
def test_files_are_short_documented_and_named_by_a_question(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= LONGEST
    assert ast.get_docstring(ast.parse(text)), "no module docstring"
    assert not set(file.stem.split("_")) & {"utils", "util", "core", "common", "helpers", "manager", "misc"}


@pytest.mark.parametrize("file", FILES, ids=[str(file.relative_to(ENGINE)) for file in FILES])
def test_files_name_no_place_on_a_machine(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    home = Path(__file__).resolve().parents[2]
    for place in (home, home.parent, Path.home()):
        assert len(place.parts) < 2 or f"{place}/" not in text
    assert "fastmath=True" not in text and "acos(" not in text and "arccos(" not in text


def test_files_that_begin_first_are_there() -> None:
    stems = [file.stem for file in (HOUSE / "tests").rglob("test_*.py")]
    assert set(longest_first.LONGEST) <= set(stems)
