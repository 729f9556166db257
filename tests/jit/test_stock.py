"""What is built upon numba makes compiling short, and nothing else: numba alone gives the same bits."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from avatarsim.jit.kernel import STOCK
from tests.house import yardstick

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", ["pairs plates", "impacts"])
def test_numba_alone_gives_the_same_bits(name: str, tmp_path: Path) -> None:
    found = tmp_path / "found.json"
    command = [sys.executable, "-m", "tests.house.yardstick", "--jobs", "1", "--filter", name, "-o", str(found)]
    environment = {**os.environ, STOCK: "1", "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(found.read_text()) == {name: yardstick.slices()[name]()}
    # numba's own cache, not the engine's
    assert any((tmp_path / "kernels").rglob("*.nbi")) and not (tmp_path / "kernels" / "avatarsim-kernels").exists()
