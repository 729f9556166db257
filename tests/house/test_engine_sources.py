"""Sources of the engine: their length, the cost of importing them, and their use of the compiler."""

import ast
import re
import subprocess
import sys
from pathlib import Path

from tests import longest_first

ROOT = Path(__file__).resolve().parents[2]
ENGINE = ROOT / "avatarsim"
TEXTS = {file: file.read_text(encoding="utf-8") for file in sorted(ENGINE.rglob("*.py"))}
LONGEST = 500
"""Maximum number of lines of a file."""
HEAVY = {
    "pandas", "trimesh", "coacd", "mujoco", "pybullet", "coal", "fcl", "itables", "jinja2", "gymnasium_robotics", "tqdm",
    "joblib", "sapien", "scipy.spatial", "scipy.optimize",
}
"""Packages whose import costs more than the engine's first frame, or with which the engine is compared."""
PRIVATE, PRIVATE_LINES = re.compile(r"numba\.core|llvmlite"), 700
"""Private parts of the compiler, and the most lines of all files together that name them."""


def imported_by(statement: str) -> set[str]:
    """Return the modules loaded after a statement in a fresh process. (numba itself imports parts of scipy.)"""
    script = f"{statement}\nimport sys\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def patches(text: str) -> list[str]:
    """Return the statements that write to attributes or elements of names imported from numba or llvmlite."""
    nodes = list(ast.walk(ast.parse(text)))
    imported = set[str]()
    for node in nodes:
        if isinstance(node, ast.Import | ast.ImportFrom):
            module = (node.module or "") if isinstance(node, ast.ImportFrom) else ""
            imported |= {(alias.asname or alias.name).partition(".")[0] for alias in node.names
                         if (module or alias.name).partition(".")[0] in ("numba", "llvmlite")}
    written = [ast.unparse(node) for node in nodes
               if isinstance(node, ast.Attribute | ast.Subscript) and not isinstance(node.ctx, ast.Load)]
    written += [f"{ast.unparse(node.args[0])}." for node in nodes
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("setattr", "delattr")]
    return [target for target in written if re.split(r"[.\[]", target)[0] in imported]


def test_no_file_is_longer_than_500_lines() -> None:
    assert {file.name for file, text in TEXTS.items() if len(text.splitlines()) > LONGEST} == set()


def test_no_kernel_uses_fastmath_or_arc_cosine() -> None:
    assert {file.name for file, text in TEXTS.items() if re.search(r"fastmath=True|\ba(rc)?cos\(", text)} == set()


def test_no_file_imports_by_dots() -> None:
    assert {file.name for file, text in TEXTS.items() if re.search(r"^\s*from \.", text, re.MULTILINE)} == set()


def test_importing_the_engine_loads_nothing_heavy() -> None:
    loaded = imported_by("import avatarsim.simulator")
    assert "numba" in loaded
    assert not loaded & HEAVY


def test_importing_the_package_or_its_meshes_loads_no_compiler() -> None:
    assert not imported_by("import avatarsim") & {"numba", "numpy", *HEAVY}
    assert not imported_by("import avatarsim.assets.meshes") & {"numba", "scipy", *HEAVY}


def test_no_file_names_a_place_on_this_machine() -> None:
    places = [f"{place}/" for place in (ROOT, ROOT.parent, Path.home()) if len(place.parts) > 1]
    assert {file.name for file, text in TEXTS.items() if any(place in text for place in places)} == set()


def test_private_parts_of_the_compiler_stay_in_one_small_folder() -> None:
    named = {file: text for file, text in TEXTS.items() if PRIVATE.search(text)}
    assert named and {file.parent for file in named} == {ENGINE / "jit"}
    assert sum(len(text.splitlines()) for text in named.values()) <= PRIVATE_LINES


def test_nothing_of_the_compiler_is_patched() -> None:
    assert patches("import numba.core as n\nn.config.X = 1\nsetattr(n, 'a', 2)") == ["n.config.X", "n."]
    near = {file: text for file, text in TEXTS.items() if "numba" in text or "llvmlite" in text}
    assert near and {file.name: found for file, text in near.items() if (found := patches(text))} == {}


def test_files_of_tests_that_begin_first_are_there() -> None:
    assert set(longest_first.LONGEST) <= {file.stem for file in (ROOT / "tests").rglob("test_*.py")}
