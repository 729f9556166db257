"""What importing the room costs, and which files import what reads meshes."""

import subprocess
import sys
from pathlib import Path

import pytest

HOUSE = Path(__file__).resolve().parents[3]


def test_importing_the_room_loads_nothing_heavy() -> None:
    script = "import avatarsim.assets.meshes, sys\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], cwd=HOUSE, capture_output=True, text=True, check=True)
    assert not set(done.stdout.split()) & {"trimesh", "coacd", "numba", "scipy", "pandas"}


@pytest.mark.parametrize("package", ["trimesh", "coacd"])
def test_one_file_imports_each_reader(package: str) -> None:
    room = HOUSE / "avatarsim" / "assets"
    assert sum(f"    import {package}\n" in file.read_text(encoding="utf-8") for file in room.rglob("*.py")) == 1
