"""Settings in the engines' own words: what is said is what the engine then has."""

import mujoco
import pytest

from scenarios.studies.sweep.grid import BY_ENGINE, Setting
from scenarios.studies.sweep.native import native


def test_words_of_mujoco_name_what_its_model_has() -> None:
    options = {"dt": 1 / 240, "cone": "PYRAMIDAL", "integrator": "DISCRETE", "iterations": 10}
    said = native(Setting("mujoco", "x", "tuned", options))
    assert said == ("opt.timestep = 0.004166666666666667; opt.cone = mujoco.mjtCone.mjCONE_PYRAMIDAL; "
                    "opt.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE; opt.iterations = 10")
    assert hasattr(mujoco.mjtCone, "mjCONE_PYRAMIDAL") and hasattr(mujoco.mjtIntegrator, "mjINT_DISCRETE")
    model = mujoco.MjSpec().compile()
    names = ("timestep", "cone", "integrator", "iterations", "disableflags", "enableflags")
    assert all(hasattr(model.opt, name) for name in names)
    assert native(Setting("mujoco", "x", "tuned", {"sleep": True})) == "opt.enableflags |= mjENBL_SLEEP"


def test_words_of_pybullet_are_its_calls() -> None:
    said = native(Setting("pybullet", "x", "tuned", {"dt": 0.001, "solver_iterations": 10, "collision_margin": 0.001}))
    assert said == ("setPhysicsEngineParameter(fixedTimeStep=0.001); setPhysicsEngineParameter(numSolverIterations=10); "
                    "changeDynamics(collisionMargin=0.001)")


def test_a_preset_and_what_only_the_adapter_knows_have_none() -> None:
    assert native(Setting("mujoco", "tuned", "tuned")) == native(Setting("mujoco", "x", "tuned", {"kappa": 0.02})) == ""
    assert native(Setting("avatarsim", "x", "default", {"steps": 1})) == ""


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_every_finer_step_has_words(engine: str) -> None:
    assert all(native(setting) for setting in BY_ENGINE[engine] if "dt" in setting.options)
