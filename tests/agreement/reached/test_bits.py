"""Reproducibility to the bit: both engines repeat a run in this process, in another one and after other scenes.
MuJoCo continues from a saved state with equal bits, PyBullet does not, and no adapter does.
"""

import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mujoco import rollout

from avatarsim.engine import Engine, Settings
from reference.in_mujoco.engine import MujocoEngine
from scenarios import catalog
from scenarios.engines import opened
from tests.agreement.reached.test_solvers import scene
from tests.agreement.rivals import STUDIED, PybulletEngine, needs_pybullet, pybullet
from tests.agreement.runs import Array, loaded, of_catalog

ROOT = Path(__file__).resolve().parents[3]
SCENE, FRAMES = "driven_10cm_wall", 60
ELSEWHERE = """
from tests.agreement.reached.test_bits import fingerprint
from scenarios.engines import opened
print(fingerprint(opened({name!r}), {preset!r}))
"""
BEFORE, AFTER = 100, 100
"""Steps until the state is saved, and after it."""
KEPT = int(mujoco.mjtState.mjSTATE_INTEGRATION)


def fingerprint(engine: Engine, preset: str) -> str:
    """Return a hash of all bits of the last state of a run."""
    return of_catalog(engine, SCENE, Settings(preset), FRAMES)[1][-1].state_hash()


@STUDIED
@pytest.mark.parametrize("preset", ["default", "tuned"])
def test_three_runs_in_this_process_are_the_same(engine: Engine, preset: str) -> None:
    assert len({fingerprint(opened(engine.name), preset) for _ in range(3)}) == 1


@STUDIED
def test_a_run_in_another_process_is_the_same(engine: Engine) -> None:
    code = ELSEWHERE.format(name=engine.name, preset="tuned")
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split()[-1] == fingerprint(opened(engine.name), "tuned")


def falling() -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Return balls knocked off balance, after BEFORE steps."""
    engine = loaded(MujocoEngine(), scene(), Settings("tuned"))
    model, data = engine._model, engine._data
    data.qvel[:6] = 1.0, 0.3, 0.5, 2.0, 1.0, 0.0
    for _ in range(BEFORE):
        mujoco.mj_step(model, data)
    return model, data


def kept(model: mujoco.MjModel, data: mujoco.MjData, parts: int) -> Array:
    state = np.empty(mujoco.mj_stateSize(model, parts))
    mujoco.mj_getState(model, data, state, parts)
    return state


def gone_on(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Return the positions (AFTER, nq) of the following steps."""
    rows = []
    for _ in range(AFTER):
        mujoco.mj_step(model, data)
        rows.append(data.qpos.copy())
    return np.array(rows)


def test_mujoco_goes_on_from_a_kept_state_bit_for_bit() -> None:
    model, data = falling()
    state = kept(model, data, KEPT)
    first = gone_on(model, data)
    other = mujoco.MjData(model)
    for again in (data, other):
        mujoco.mj_setState(model, again, state, KEPT)
        assert np.array_equal(gone_on(model, again), first)


def test_mujoco_s_rollout_is_its_loop_bit_for_bit() -> None:
    model, data = falling()
    start = kept(model, data, int(mujoco.mjtState.mjSTATE_FULLPHYSICS))
    warm, led = data.qacc_warmstart.copy(), mujoco.MjData(model)
    led.mocap_pos[:], led.mocap_quat[:] = data.mocap_pos, data.mocap_quat
    spec = int(mujoco.mjtState.mjSTATE_MOCAP_POS) | int(mujoco.mjtState.mjSTATE_MOCAP_QUAT)
    control = np.tile(kept(model, data, spec), (AFTER, 1))
    states, _ = rollout.rollout(model, led, start, control, control_spec=spec, nstep=AFTER, initial_warmstart=warm)
    # time comes first
    assert np.array_equal(states[0][:, 1 : 1 + model.nq], gone_on(model, data))


@needs_pybullet
def test_pybullet_does_not_go_on_from_a_kept_state_as_it_did() -> None:
    """Boxes that slide over seams; with few contacts PyBullet continues with equal bits."""
    scenario = catalog.get("seams")
    world, engine = scenario.build(), PybulletEngine()
    motion = scenario.motion(world, 0)
    engine.load(world, Settings("tuned"), scenario.dt)
    for frame in range(5):
        engine.advance(motion(frame), scenario.dt)
    client, bodies = engine._client, [part.body for part in engine._world.parts]

    def on() -> Array:
        for _ in range(AFTER):
            pybullet.stepSimulation(physicsClientId=client)
        return np.array([pybullet.getBasePositionAndOrientation(body, physicsClientId=client)[0] for body in bodies])

    state = pybullet.saveState(physicsClientId=client)
    first = on()
    pybullet.restoreState(state, physicsClientId=client)
    again = on()
    engine.close()
    assert not np.array_equal(again, first)
    np.testing.assert_allclose(again, first, atol=0.01)
