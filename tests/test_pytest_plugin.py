"""The fixtures `compare` and `drift` in a repository of a user: two tests, one failing as it should."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.test_comparing import BOX, ROOT

TESTS = """
QUICK = {"engines": ["avatarsim", "tracker"], "options": ("--frames", "30", "--jobs", "0")}


def test_overlap(compare):
    assert compare("scenes/box.xml", **QUICK).overlap["avatarsim/default"] < 1e-3


def test_too_much(compare):
    assert compare("scenes/box.xml", **QUICK).overlap["avatarsim/default"] < -1.0


def test_drift(drift):
    drift("scenes/box.xml", **QUICK)
"""


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    (tmp_path / "tests" / "scenes").mkdir(parents=True)
    (tmp_path / "tests" / "scenes" / "box.xml").write_text(BOX)
    (tmp_path / "tests" / "test_cell.py").write_text(TESTS)
    return tmp_path


def asked(repository: Path, *words: str) -> tuple[int, str]:
    """Return exit code and output of pytest in the repository of the user, as where the package is installed."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTEST_ADDOPTS": "", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    command = [sys.executable, "-P", "-m", "pytest", "-q", "-p", "avatarsim.pytest_plugin", "-p", "no:cacheprovider", *words]
    done = subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


def test_one_passes_and_one_fails_as_it_should(repository: Path) -> None:
    code, said = asked(repository, "-k", "not drift")
    assert code == 1 and "1 failed, 1 passed" in said and "test_too_much" in said


def test_the_gate_on_drift_writes_compares_and_fails(repository: Path) -> None:
    file = repository / "tests" / "box.drift.json"
    code, said = asked(repository, "-k", "drift")
    assert code == 1 and "InvalidFile" in said and not file.exists()
    assert asked(repository, "-k", "drift", "--update-drift")[0] == 0
    assert asked(repository, "-k", "drift")[0] == 0
    kept = json.loads(file.read_text())
    run = kept["runs"]["own_box avatarsim/default"]
    run["version"], run["figures"]["residual_overlap_max"] = "0.0.1", 0.5
    file.write_text(json.dumps(kept))
    code, said = asked(repository, "-k", "drift")
    assert code == 1 and all(part in said for part in ("residual_overlap_max", "0.5 m", "0.0.1", "--update-drift"))


def test_without_a_use_nothing_is_imported() -> None:
    code = "import sys, avatarsim.pytest_plugin; print({'numpy', 'numba', 'pandas', 'avatarsim.comparing'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
