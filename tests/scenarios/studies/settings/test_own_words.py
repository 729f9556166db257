"""Settings in the engines' own names: applied to the loaded preset, they give the model that the row loads."""

import ast
import gzip
from collections.abc import Mapping
from pathlib import Path

import mujoco
import numpy as np
import pytest

from avatarsim.engine import Settings
from reference.in_mujoco.engine import MujocoEngine
from runfiles.engines import about
from scenarios import catalog
from scenarios.studies.settings.grid import Setting, applicable
from tests.scenarios.studies.settings.grids import GRIDS

ROUNDED = 1e-11
"""Largest relative difference of numbers that are scaled and not computed anew."""


def model_of(scene: str, preset: str, options: Mapping[str, object]) -> mujoco.MjModel:
    """Return the model that a reader compiles from a run's file of a scene."""
    scenario, engine = catalog.get(scene), MujocoEngine()
    engine.load(scenario.as_run(False).build(), Settings(preset, options), scenario.dt)
    return mujoco.MjModel.from_xml_string(engine.native()[1])


def differs(one: object, other: object) -> list[str]:
    """Return the names of numbers and arrays that differ."""
    apart = ("opt", "vis", "stat", "signature")
    names = [name for name in dir(one) if not name.startswith("_") and name not in apart]
    both = [(name, getattr(one, name), getattr(other, name)) for name in names]
    told = [(name, a, b) for name, a, b in both if isinstance(a, int | float | np.ndarray)]
    return [name for name, a, b in told if not np.allclose(a, b, rtol=ROUNDED, atol=0.0)]


def all_that_differs(one: mujoco.MjModel, other: mujoco.MjModel) -> list[str]:
    """Return the differences of a model and of its options."""
    return differs(one, other) + differs(one.opt, other.opt)


def settable(setting: Setting) -> str:
    """Return a setting in the engine's own names, or "" if it also changes other parts of the model of its preset."""
    one = about(setting.engine)
    return "\n".join(one.in_own_words(setting.options)) if set(setting.options) <= set(one.alone) else ""


SCENES = ("stop_distance", "stack_ten", "driven_10cm_wall", "ball_off_table")
SAID = [setting for setting in GRIDS["mujoco"] if settable(setting)]


@pytest.mark.parametrize("setting", SAID, ids=lambda setting: setting.run)
def test_words_of_mujoco_make_the_model_of_the_row(setting: Setting) -> None:
    changed = False
    for scene in (scene for scene in SCENES if applicable(setting, catalog.get(scene).as_run(False).build())):
        told, row = model_of(scene, setting.base, {}), model_of(scene, setting.base, setting.options)
        changed |= bool(all_that_differs(told, row))
        exec(settable(setting), {"model": told, "mujoco": mujoco, "np": np})
        assert all_that_differs(told, row) == []
    assert changed


def test_another_step_changes_more_than_the_timestep() -> None:
    told, row = model_of("stack_ten", "tuned", {}), model_of("stack_ten", "tuned", {"dt": 1 / 480})
    told.opt.timestep = row.opt.timestep
    assert "geom_solref" in all_that_differs(told, row)


def test_words_of_pybullet_are_its_calls() -> None:
    said = settable(Setting("pybullet", "x", "tuned", {"solver_iterations": 10, "collision_margin": 0.001, "sleep": True}))
    calls = {ast.unparse(node.func) for node in ast.walk(ast.parse(said)) if isinstance(node, ast.Call)}
    assert {"pybullet.setPhysicsEngineParameter", "pybullet.changeDynamics"} <= calls
    free = {node.id for node in ast.walk(ast.parse(said)) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
    bound = {node.id for node in ast.walk(ast.parse(said)) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    assert free - bound <= {"pybullet", "map", "range"}


def test_a_preset_is_loaded_from_the_file_that_a_run_leaves(tmp_path: Path) -> None:
    scenario, engine = catalog.get("stack_ten"), MujocoEngine()
    engine.load(scenario.as_run(False).build(), Settings("tuned"), scenario.dt)
    (tmp_path / "a.xml.gz").write_bytes(gzip.compress(engine.native()[1].encode()))
    names: dict[str, object] = {}
    exec(about("mujoco").loads.format(file=tmp_path / "a.xml.gz", preset="tuned"), names)
    assert isinstance(names["model"], mujoco.MjModel)
    assert all_that_differs(names["model"], model_of("stack_ten", "tuned", {})) == []
