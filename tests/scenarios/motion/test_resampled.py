"""A motion at another rate: uniform motions are equal, whole samples are equal to the bit, bounds are equal."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios import catalog, unseen
from scenarios.motion.resampled import HEADSET, at_rate, resampled
from scenarios.scenario import RENDERED, Motion, Scenario

FASTER = 1.0 / HEADSET
SPIN, SPEED = 2.0, 0.6


def at(time: float) -> TrackerSample:
    """Return a link that moves and turns uniformly, and a hinge that turns uniformly."""
    turn = rotation.from_axis_angle((0.0, 0.6, 0.8), SPIN * time)
    return TrackerSample(time, np.array([[SPEED * time, 0.0, 1.0]]), turn.reshape(1, 4), np.array([3.0 * time]))


def even(frame: int) -> TrackerSample:
    return at((frame + 1) * RENDERED)


@pytest.mark.parametrize("step", [FASTER, RENDERED, 1.0 / 30.0, 1.0 / 144.0])
def test_an_even_motion_is_the_same_motion_at_every_rate(step: float) -> None:
    motion = resampled(even, at(0.0), RENDERED, step)
    for frame in range(40):
        found, wanted = motion(frame), at((frame + 1) * step)
        assert found.time == pytest.approx(wanted.time)
        np.testing.assert_allclose(found.positions, wanted.positions, atol=1e-12)
        np.testing.assert_allclose(found.rotations, wanted.rotations, atol=1e-12)
        np.testing.assert_allclose(found.angles, wanted.angles, atol=1e-12)


def test_whole_samples_at_90_hz_equal_those_at_60_to_the_bit() -> None:
    motion = resampled(even, at(0.0), RENDERED, FASTER)
    for frame in range(2, 60, 3):
        whole = even(2 * (frame + 1) // 3 - 1)
        assert (motion(frame).positions == whole.positions).all() and (motion(frame).rotations == whole.rotations).all()


def test_scenes_at_90_hz_take_as_long_and_promise_the_same() -> None:
    for found in (catalog, unseen):
        for name, scenario in found.scenarios().items():
            if name.endswith(f"_{HEADSET}hz"):
                slow = found.get(name.removesuffix(f"_{HEADSET}hz"))
                assert scenario.dt == FASTER and scenario.bounds == slow.bounds
                assert scenario.family == (slow.family or slow.name)
                for full in (False, True):
                    fast, whole = scenario.as_run(full), slow.as_run(full)
                    assert fast.frames * fast.dt == pytest.approx(whole.frames * whole.dt, abs=0.6 * FASTER)
    names = {name for found in (catalog, unseen) for name in found.scenarios() if name.endswith("hz")}
    assert names == {"hand_over_table_90hz", "mocap_punch_wall_90hz", "unseen_door_90hz"}


def test_the_short_motion_is_resampled_too() -> None:
    def constant(x: float) -> Callable[[Scene, int], Motion]:
        return lambda scene, seed: lambda frame: replace(at((frame + 1) * RENDERED), positions=np.full((1, 3), x))

    scenario = at_rate(Scenario("x", "X.", "Y.", lambda: catalog.get("hand_over_table").build(), constant(1.0), 60, short=30,
                                short_motion=constant(2.0)))
    scene = scenario.build()
    assert scene.name == scenario.name == "x_90hz" and (scenario.frames, scenario.short) == (90, 45)
    for full, x in ((True, 1.0), (False, 2.0)):
        assert scenario.as_run(full).motion(scene, 0)(5).positions[0, 0] == x
