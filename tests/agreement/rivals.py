"""The engines that are compared, those of them that are installed: PyBullet has no wheel for every Python."""

from importlib.util import find_spec
from typing import Any

import pytest

from avatarsim.engine import Engine
from reference.in_mujoco.engine import MujocoEngine

HAS_PYBULLET = find_spec("pybullet") is not None

needs_pybullet = pytest.mark.skipif(not HAS_PYBULLET, reason="pybullet is not installed; `make setup` says why")

pybullet: Any = None
PybulletEngine: Any = None
if HAS_PYBULLET:
    import pybullet as installed

    from reference.in_pybullet.engine import PybulletEngine as Installed

    pybullet, PybulletEngine = installed, Installed

RIVALS: list[Engine] = [MujocoEngine(), *([PybulletEngine()] if HAS_PYBULLET else [])]
ENGINES = pytest.mark.parametrize("engine", RIVALS, ids=[engine.name for engine in RIVALS])
