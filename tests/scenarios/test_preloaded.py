"""The mother of all children has loaded what they need, no engine, and nothing stops her."""

import subprocess
import sys

import pytest

from scenarios import preloaded

SAID = """
import gc
import sys
import scenarios.preloaded
needed = ("scenarios.run", "reference.judge", "reference.targets", "scenarios.catalog.ball_drop")
engines = ("mujoco", "pybullet", "avatarsim.simulator", "reference.in_mujoco.engine", "reference.in_pybullet.engine")
print(all(name in sys.modules for name in needed), any(name in sys.modules for name in engines))
frozen = gc.get_freeze_count()
print(frozen > 10 * len(gc.get_objects()))
"""


def test_what_is_needed_is_loaded_and_no_engine_and_no_collector_goes_through_it() -> None:
    said = subprocess.run([sys.executable, "-c", SAID], capture_output=True, text=True, check=True, timeout=120.0)
    assert said.stdout.split() == ["True", "False", "True"]


def test_a_module_at_fault_is_left_to_who_needs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def broken() -> None:
        asked.append("first")
        raise RuntimeError("this file is being edited")

    monkeypatch.setattr(preloaded, "every_scene", broken)
    monkeypatch.setattr(preloaded, "sources_read", lambda: asked.append("last"))
    preloaded.preload()
    assert asked == ["first", "last"]
