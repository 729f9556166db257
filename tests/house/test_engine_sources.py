"""Sources of the engine: their length, the cost of importing them, and their use of the compiler."""

import re
import subprocess
import sys
from pathlib import Path

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


def imported_by(statement: str) -> set[str]:
    """Return the modules loaded after a statement in a fresh process. (numba itself imports parts of scipy.)"""
    script = f"{statement}\nimport sys\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_no_file_is_longer_than_500_lines() -> None:
    assert {file.name for file, text in TEXTS.items() if len(text.splitlines()) > LONGEST} == set()


def test_no_kernel_uses_fastmath_or_the_ill_conditioned_arc_cosine() -> None:
    assert {file.name for file, text in TEXTS.items() if re.search(r"fastmath=True|\ba(rc)?cos\(", text)} == set()


def test_no_file_imports_by_dots_which_the_cache_of_kernels_would_have_to_guess() -> None:
    assert {file.name for file, text in TEXTS.items() if re.search(r"^\s*from \.", text, re.MULTILINE)} == set()


def test_importing_the_engine_loads_nothing_heavy() -> None:
    loaded = imported_by("import avatarsim.simulator")
    assert "numba" in loaded
    assert not loaded & HEAVY


def test_importing_the_package_or_its_meshes_loads_no_compiler() -> None:
    assert not imported_by("import avatarsim") & {"numba", "numpy", *HEAVY}
    assert not imported_by("import avatarsim.assets.meshes") & {"numba", "scipy", *HEAVY}
