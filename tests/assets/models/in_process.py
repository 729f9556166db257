"""MuJoCo's compiler in this process, for tests of what is made of its answer: a process of its own takes a third of a second."""

import io
import warnings
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from avatarsim.assets.models import compile_process, compiled

APART = {"test_public_models", "test_killed", "test_cluster"}
"""Files of tests in which models are compiled as users do it."""
IN_A_PROCESS = compiled._run
"""The compiler in a process of its own, with limits."""


def run_here(path: Path, folder: Path, scale: float, collide: str) -> bytes:
    """Return the bytes that the process would send. Raises what it refuses."""
    buffer, place = io.BytesIO(), path.absolute()
    with TemporaryDirectory(prefix="avatarsim-model-") as nowhere, chdir(nowhere), warnings.catch_warnings(action="ignore"):
        np.savez(buffer, **compile_process.compiled(place, folder, scale, collide))
    return buffer.getvalue()


@pytest.fixture(autouse=True)
def models_compiled_here(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compile the models of a test in this process, without limits."""
    if request.path.stem not in APART:
        compile_here(monkeypatch)


def compile_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compile models in this process until the end of a test."""
    monkeypatch.setattr(compile_process, "limit", lambda seconds: None)
    monkeypatch.setattr(compiled, "_run", run_here)
