"""Over the whole catalogue: unused effects are skipped, take no time, and change nothing when they are forced on."""

from dataclasses import fields, replace

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.body import Role
from avatarsim.scene.effects import Effects
from avatarsim.scene.scene import Scene
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog
from scenarios.scenario import REFUSAL, Scenario

FRAMES = 12
"""Frames of each scene: enough for contacts in most of them, few enough for all seventy."""

STAGES = {"posture": "overlap_removal", "motion": "dynamics", "coupling": "coupling"}
"""Effect of each stage of a frame."""

NAMES = [name for name, scenario in catalog.scenarios().items() if not scenario.expects.get(REFUSAL)]


def shown(scenario: Scenario, scene: Scene, force: tuple[str, ...]) -> tuple[list[FrameRecord], AvatarsimEngine]:
    """Return the first frames of a scene, with these effects forced on."""
    scene = replace(scene, force=force)
    motion, engine = scenario.motion(scene, 0), AvatarsimEngine()
    records = [engine.load(scene, Settings(time_stages=True), scenario.dt)]
    records += [engine.advance(motion(k), scenario.dt) for k in range(min(FRAMES, scenario.frames))]
    return records, engine


@pytest.mark.parametrize("name", NAMES)
def test_unused_effects_are_skipped_and_change_nothing_if_forced(name: str) -> None:
    scenario = catalog.get(name).as_run(full=False)
    scene = scenario.build()
    effects = scene.effects
    plain, engine = shown(scenario, scene, ())
    for stage, effect in STAGES.items():
        if not getattr(effects, effect):
            assert engine.stage_calls()[stage] == 0
            assert all(record.stage_ns.get(stage, 0) == 0 for record in plain)
        else:
            assert engine.stage_calls()[stage] > 0
    off = tuple(effect.name for effect in fields(Effects) if not getattr(effects, effect.name))
    forced, _ = shown(scenario, scene, off)
    # Velocities of driven bodies are computed only where simulated bodies may meet them.
    free = [k for k, role in enumerate(scene.roles) if effects.coupling or role is Role.SIMULATED]
    for a, b in zip(plain, forced, strict=True):
        for what in ("positions", "orientations"):
            np.testing.assert_allclose(getattr(b.shown, what), getattr(a.shown, what), rtol=1e-12, atol=1e-12, err_msg=what)
        for what in ("velocities", "angular_velocities"):
            np.testing.assert_allclose(getattr(b.shown, what)[free], getattr(a.shown, what)[free], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(b.angles, a.angles, atol=1e-12)
