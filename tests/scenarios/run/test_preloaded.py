"""The fork server has loaded the modules of worker processes but no engine; a part that fails does not stop the others."""

import subprocess
import sys

import pytest

from scenarios.run import preloaded

LOADED = """
import sys
import scenarios.run.preloaded
needed = {"scenarios.run.accuracy", "reference.judging.judge", "reference.targets", "scenarios.catalog.paper.ball_drop"}
engines = {"mujoco", "pybullet", "avatarsim.simulator", "reference.in_mujoco.engine", "reference.in_pybullet.engine"}
print(needed <= set(sys.modules), bool(engines & set(sys.modules)))
"""


def test_modules_of_workers_are_loaded_and_no_engine() -> None:
    ran = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=True, timeout=120.0)
    assert ran.stdout.split() == ["True", "False"]


def test_a_part_that_fails_is_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[str] = []

    def broken() -> None:
        ran.append("first")
        raise RuntimeError("this file is being edited")

    monkeypatch.setattr(preloaded, "catalogue", broken)
    monkeypatch.setattr(preloaded, "source_hash", lambda: ran.append("last"))
    preloaded.preload()
    assert ran == ["first", "last"]
