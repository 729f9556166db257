"""Which room may import which, what an import costs, and how long a file may be."""

import ast
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
    "pandas", "trimesh", "coacd", "mujoco", "pybullet", "coal", "fcl", "altair", "jinja2", "gymnasium_robotics", "tqdm", "joblib",
    "scipy.spatial", "scipy.optimize",
)
"""Packages that cost more to import than the engine's first frame, or that the engine is compared with."""

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
