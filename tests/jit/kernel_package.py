"""A small package with our kernel decorator, so that the files kept on disk can be tried without compiling the engine."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from avatarsim.jit.source_hash import ROOT

COPIED = (
    "errors.py", "console.py", "files.py", "jit",
)
"""Modules of the decorator."""


def make_package(folder: Path) -> Path:
    """Return a package `avatarsim` in `folder` that holds the decorator and nothing to compile."""
    root = folder / "avatarsim"
    root.mkdir(parents=True)
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, root / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, root)
    (root / "__init__.py").write_text("")
    return root


def plain_environment(package: Path, **environment: str) -> dict[str, str]:
    """Return the environment of a process that imports `package`, without settings of numba or of caches from outside."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "XDG_", "PYTHON", "AVATARSIM_"))}
    return kept | {"PYTHONPATH": str(package.parent), "PYTHONDONTWRITEBYTECODE": "1", **environment}


def run_in(package: Path, program: str, **environment: str) -> tuple[str, str]:
    """Return a program's output and its standard error, from a process of its own."""
    command = [sys.executable, "-c", program]
    done = subprocess.run(
        command, env=plain_environment(package, **environment), cwd=package.parent, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr
