"""A run's files in a simulator's own format match the run: MJCF that compiles to the same model, calls that Bullet accepts."""

import gzip
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from avatarsim.engine import Settings
from reference.in_mujoco.engine import MujocoEngine
from runfiles import native_files
from runfiles.naming import COMPILED
from scenarios import catalog
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.run.run_files import write_native, write_steps
from tests.agreement.rivals import PybulletEngine, needs_pybullet, pybullet
from tests.agreement.runs import loaded

WRITTEN = 1e-13
"""Largest relative difference of a number written with 17 digits, sometimes as part of a sum."""
FIELDS = (
    "geom_solref", "geom_solimp", "geom_margin", "geom_gap", "geom_condim", "geom_friction", "geom_type", "geom_size",
    "pair_solref", "pair_solreffriction", "pair_solimp", "pair_margin", "pair_friction", "jnt_solref", "jnt_range",
    "tendon_solref_lim", "tendon_range", "eq_solref", "eq_solimp", "eq_data", "body_mass", "body_inertia",
    "body_gravcomp", "dof_armature", "actuator_gainprm", "actuator_biasprm", "actuator_forcerange", "exclude_signature",
)
"""Fields that define how a model is simulated."""


@pytest.mark.parametrize(("name", "preset"), [
    ("stack_ten", "tuned"), ("mocap_punch_wall", "tuned"), ("mocap_punch_wall", "servos"), ("driven_10cm_wall", "default"),
    ("falling_rod", "default"),
])
def test_the_xml_of_a_scene_compiles_to_the_model_that_was_run(name: str, preset: str) -> None:
    scenario = catalog.get(name)
    scene = scenario.build()
    engine = loaded(MujocoEngine(), scene, Settings(preset), scenario.dt)
    ending, text = engine.native()
    assert ending == "xml" and engine.native() == (ending, text)
    ours, theirs = engine._model, mujoco.MjModel.from_xml_string(text)
    for field in FIELDS:
        assert np.allclose(getattr(theirs, field), getattr(ours, field), rtol=WRITTEN, atol=WRITTEN), field
    for option in ("integrator", "cone", "solver", "iterations", "disableflags", "enableflags", "noslip_iterations"):
        assert getattr(theirs.opt, option) == getattr(ours.opt, option), option
    assert theirs.opt.timestep == pytest.approx(ours.opt.timestep, rel=WRITTEN)
    assert np.allclose(theirs.key_qpos[0], engine._data.qpos, rtol=WRITTEN, atol=WRITTEN)


def test_a_told_scene_plays_again_without_this_project(tmp_path: Path) -> None:
    scenario, engine, frames = catalog.get("mocap_punch_wall"), MujocoEngine(), 12
    scene, job = scenario.build(), Job("mocap_punch_wall", "mujoco", "tuned")
    engine.load(scene, Settings("tuned"), scenario.dt)
    assert not write_native(engine, tmp_path, job, everyday=False) and write_native(engine, tmp_path, job, everyday=True)
    motion = scenario.motion(scene, 0)
    for k in range(frames):
        engine.advance(motion(k), scenario.dt)
    write_steps(engine, tmp_path, job)
    steps, program = native_files.steps_written(tmp_path, "mocap_punch_wall", "mujoco/tuned", 0)
    model = native_files.written(tmp_path, "mocap_punch_wall", "mujoco/tuned", 0)
    ran = subprocess.run([sys.executable, *(str(tmp_path / name) for name in (program, model, steps))], capture_output=True,
                         text=True, check=True, timeout=60.0)
    told = np.array(ran.stdout.partition("qpos ends at [")[2].replace("]", "").split(), dtype=np.float64)
    assert np.allclose(told, engine._data.qpos, rtol=0.0, atol=1e-7)
    assert native_files.steps_written(tmp_path, "mocap_punch_wall", "mujoco/default", 0) == ()


def test_numbers_of_a_compiled_scene_are_among_its_settings() -> None:
    scenario = catalog.get("driven_10cm_wall")
    engine = loaded(MujocoEngine(), scenario.build(), Settings("tuned"), scenario.dt)
    run = {name.removeprefix(COMPILED): entry[0] for name, entry in engine.settings_as_run().items() if isinstance(entry, tuple)}
    assert run["flag autoreset"] is False and run["flag nativeccd"] is True and run["exclusions"] == engine._model.nexclude


@needs_pybullet
@pytest.mark.parametrize(("name", "preset"), [
    ("ball_drop", "tuned"), ("mocap_punch_wall", "tuned"), ("mocap_punch_wall", "default"),
])
def test_the_calls_set_bullet_as_it_was_run(name: str, preset: str) -> None:
    scenario = catalog.get(name)
    engine = loaded(PybulletEngine(), scenario.build(), Settings(preset), scenario.dt)
    ending, text = engine.native()
    given: list[tuple[str, tuple[object, ...], dict[str, object]]] = []

    def taken(function: str) -> object:
        return lambda *positional, **named: given.append((function, positional, named))

    functions = set(re.findall(r"pybullet\.([a-z]\w+)", text))
    fake = SimpleNamespace(**{word: taken(word) for word in functions}, POSITION_CONTROL=pybullet.POSITION_CONTROL)
    words = ("target_centre", "target_turn", "target_angles", "target_speeds", "target_turns", "velocity", "spin")
    targets = dict.fromkeys(words)
    exec(compile(text.replace("import pybullet\n", ""), name, "exec"), {"pybullet": fake, **targets})
    assert ending == "py" and all(hasattr(pybullet, function) for function in functions)
    parameters = {
        key: value for function, _, named in given if function == "setPhysicsEngineParameter" for key, value in named.items()
    }
    in_force = pybullet.getPhysicsEngineParameters(physicsClientId=engine._client)
    for key in ("fixedTimeStep", "numSolverIterations", "contactSlop", "contactERP"):
        assert key not in parameters or key not in in_force or in_force[key] == pytest.approx(parameters[key]), key
    assert parameters["fixedTimeStep"] == engine._step
    dynamics = [(positional, named) for function, positional, named in given if function == "changeDynamics"]
    shapes = {carrier for part in engine._world.parts for carrier in part.carriers}
    for (body, link), named in dynamics:
        info = pybullet.getDynamicsInfo(body, link, physicsClientId=engine._client)
        # for a link without a shape Bullet returns its default; for one with a shape it returns the value in use
        if (body, link) in shapes and "lateralFriction" in named:
            assert info[1] == pytest.approx(named["lateralFriction"])
    assert len(dynamics) >= len(engine._world.parts)
    assert ("setJointMotorControlMultiDofArray" in functions) is name.startswith("mocap")
    engine.close()


def test_a_run_keeps_the_scene_once_if_its_engine_tells_it(tmp_path: Path) -> None:
    scenario = catalog.get("driven_10cm_wall")
    engine = loaded(MujocoEngine(), scenario.build(), Settings("tuned"), scenario.dt)
    write_native(engine, tmp_path, Job("driven_10cm_wall", "mujoco", "tuned"), everyday=False)
    path = native_files.written(tmp_path, "driven_10cm_wall", "mujoco/tuned", 0)
    assert gzip.decompress((tmp_path / path).read_bytes()).decode() == engine.native()[1]
    before = (tmp_path / path).read_bytes()
    write_native(engine, tmp_path, Job("driven_10cm_wall", "mujoco", "tuned"), everyday=False)
    assert (tmp_path / path).read_bytes() == before
    write_native(opened("tracker"), tmp_path, Job("driven_10cm_wall", "tracker", "default"), everyday=False)
    assert native_files.written(tmp_path, "driven_10cm_wall", "tracker/default", 0) == ""


@pytest.mark.parametrize("preset", ["default", "tuned"])
@pytest.mark.parametrize("name", ["falling_rod", "painleve"])
def test_a_floor_of_rods_is_the_plane_of_its_top(name: str, preset: str) -> None:
    scenario = catalog.get(name)
    scene = scenario.build()
    engine = loaded(MujocoEngine(), scene, Settings(preset), scenario.dt)
    model = engine._model
    floors = np.flatnonzero(model.geom_type == int(mujoco.mjtGeom.mjGEOM_PLANE))
    assert [scene.names[0]] == ["floor"] and len(floors) == 1
    assert model.geom_pos[floors[0]] + scene.bodies[0].position == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    most = 0
    for k in range(scenario.frames):
        most = max(most, int(engine.advance(scenario.motion(scene, 0)(k), scenario.dt).counts["contacts"]))
    assert most == 2 * (len(scene.bodies) - 1)
