"""Settings in the engines' own names: applied to the loaded preset, they give the model that the row loads."""

import ast
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


def model_of(scene: str, preset: str, options: Mapping[str, object]) -> mujoco.MjModel:
    """Return the model that a reader compiles from a run's file of a scene."""
    scenario, engine = catalog.get(scene), MujocoEngine()
    engine.load(scenario.as_run(False).build(), Settings(preset, options), scenario.dt)
    return mujoco.MjModel.from_xml_string(engine.native()[1])


def differs(one: object, other: object) -> list[str]:
    """Return the names of numbers and arrays that differ."""
    names = [name for name in dir(one) if not name.startswith("_") and name not in ("opt", "vis", "stat")]
    both = [(name, getattr(one, name), getattr(other, name)) for name in names]
    return [name for name, a, b in both if isinstance(a, int | float | np.ndarray) and not np.array_equal(a, b)]


def all_that_differs(one: mujoco.MjModel, other: mujoco.MjModel) -> list[str]:
    """Return the differences of a model and of its options."""
    return differs(one, other) + differs(one.opt, other.opt)


def settable(setting: Setting) -> str:
    """Return a setting in the engine's own names, or "" if it also changes other parts of the model of its preset."""
    one = about(setting.engine)
    return "; ".join(one.in_own_words(setting.options)) if set(setting.options) <= set(one.alone) else ""


SCENES = ("stop_distance", "stack_ten", "driven_10cm_wall")
SAID = [setting for setting in GRIDS["mujoco"] if settable(setting)]


@pytest.mark.parametrize("setting", SAID, ids=lambda setting: setting.run)
def test_words_of_mujoco_make_the_model_of_the_row(setting: Setting) -> None:
    changed = False
    for scene in (scene for scene in SCENES if applicable(setting, catalog.get(scene).as_run(False).build())):
        told, row = model_of(scene, setting.base, {}), model_of(scene, setting.base, setting.options)
        changed |= bool(all_that_differs(told, row))
        exec(settable(setting), {"model": told, "mujoco": mujoco})
        assert all_that_differs(told, row) == []
    assert changed


def test_another_step_changes_more_than_the_timestep() -> None:
    told, row = model_of("stack_ten", "tuned", {}), model_of("stack_ten", "tuned", {"dt": 1 / 480})
    told.opt.timestep = row.opt.timestep
    assert "geom_solref" in all_that_differs(told, row)


def test_words_of_pybullet_are_its_calls() -> None:
    said = settable(Setting("pybullet", "x", "tuned", {"solver_iterations": 10, "collision_margin": 0.001}))
    calls = [ast.parse(call).body[0] for call in said.split("; ")]
    functions = [ast.unparse(call).partition("(")[0] for call in calls]
    assert functions == ["pybullet.setPhysicsEngineParameter", "pybullet.changeDynamics"]
    assert "numSolverIterations=10)" in said and "collisionMargin=0.001)" in said


def test_a_preset_is_loaded_from_the_file_that_a_run_leaves(tmp_path: Path) -> None:
    scenario, engine = catalog.get("stack_ten"), MujocoEngine()
    engine.load(scenario.as_run(False).build(), Settings("tuned"), scenario.dt)
    (tmp_path / "a.xml").write_text(engine.native()[1])
    names: dict[str, object] = {"mujoco": mujoco}
    exec(about("mujoco").loads.format(file=tmp_path / "a.xml", preset="tuned"), names)
    assert isinstance(names["model"], mujoco.MjModel)
    assert all_that_differs(names["model"], model_of("stack_ten", "tuned", {})) == []
