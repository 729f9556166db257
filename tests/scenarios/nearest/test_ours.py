"""Our own postures on a small sample of one real scene; the command takes all."""

from dataclasses import replace

import numpy as np

from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog
from scenarios.nearest.frames import Frames
from scenarios.nearest.summary import summarised
from tests.scenarios.examples import recorded


def test_an_arm_in_a_corner_is_within_twice_the_nearest_free_posture() -> None:
    scenario = replace(catalog.get("arm_in_corner").as_run(False), frames=250)
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    samples = [motion(k) for k in range(scenario.frames)]
    engine = AvatarsimEngine()
    frames = [engine.load(scene, Settings(), scenario.dt), *(engine.advance(sample, scenario.dt) for sample in samples)]
    shown = [frame.shown for frame in frames]
    recording = replace(
        recorded(scene, [scene.first_sample, *samples]), positions=np.array([one.positions for one in shown]),
        orientations=np.array([one.orientations for one in shown]), angles=np.array([frame.angles for frame in frames]),
    )
    found = list(Frames(scenario, scene, recording, []).samples(2))
    summary = summarised(found)
    assert summary.lost == 0 and summary.within
    # what the search ends at is nearer, by its own weights, than what was shown; otherwise it has found nothing
    assert all(np.hypot(s.nearest_offset, s.arm * s.nearest_angle) <= np.hypot(s.offset, s.arm * s.angle) + 1e-5 for s in found)
    assert summary.nearest_offset > 1e-3
