"""The fork server has loaded what worker processes need, no engine, and no failing import stops it."""

import subprocess
import sys

import pytest

from scenarios.run import preloaded

SAID = """
import sys
import scenarios.run.preloaded
needed = ("scenarios.run.accuracy", "reference.judging.judge", "reference.targets", "scenarios.catalog.paper.ball_drop")
engines = ("mujoco", "pybullet", "avatarsim.simulator", "reference.in_mujoco.engine", "reference.in_pybullet.engine")
print(all(name in sys.modules for name in needed), any(name in sys.modules for name in engines))
"""


def test_what_is_needed_is_loaded_and_no_engine() -> None:
    said = subprocess.run([sys.executable, "-c", SAID], capture_output=True, text=True, check=True, timeout=120.0)
    assert said.stdout.split() == ["True", "False"]


def test_a_module_at_fault_is_left_to_who_needs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def broken() -> None:
        asked.append("first")
        raise RuntimeError("this file is being edited")

    monkeypatch.setattr(preloaded, "catalogue", broken)
    monkeypatch.setattr(preloaded, "source_hash", lambda: asked.append("last"))
    preloaded.preload()
    assert asked == ["first", "last"]
