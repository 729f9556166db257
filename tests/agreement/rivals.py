"""Compared engines that are installed.
PyBullet does not have a wheel for every Python, and PhysX has its own extra."""

from importlib.util import find_spec
from typing import Any

import pytest

from avatarsim.engine import Engine
from reference.in_mujoco.engine import MujocoEngine
from reference.in_rapier.engine import RapierEngine

HAS_PYBULLET = find_spec("pybullet") is not None

needs_pybullet = pytest.mark.skipif(not HAS_PYBULLET, reason="pybullet is not installed; `make setup` says why")

pybullet: Any = None
PybulletEngine: Any = None
if HAS_PYBULLET:
    import pybullet as installed

    from reference.in_pybullet.engine import PybulletEngine as Installed

    pybullet, PybulletEngine = installed, Installed

STUDIED_ENGINES: list[Engine] = [MujocoEngine(), *([PybulletEngine()] if HAS_PYBULLET else [])]
STUDIED = pytest.mark.parametrize("engine", STUDIED_ENGINES, ids=[engine.name for engine in STUDIED_ENGINES])
"""Engines whose best figures are known from separate studies (`tests/agreement/reached`)."""
RIVALS = [*STUDIED_ENGINES, RapierEngine()]
if find_spec("sapien") is not None:
    from reference.in_physx.engine import PhysxEngine

    RIVALS = [*RIVALS, PhysxEngine()]
ENGINES = pytest.mark.parametrize("engine", RIVALS, ids=[engine.name for engine in RIVALS])


def digits(engine: Engine, double: float, single: float) -> float:
    """Return the tolerance for an engine: `single` for one that computes in single precision."""
    return single if engine.name in ("physx", "rapier") else double
