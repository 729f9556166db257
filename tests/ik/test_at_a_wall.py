"""A human that the user drives into a wall: limbs that press on it come to rest, and do not go to and fro on the way."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from avatarsim.engine import Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses_each
from avatarsim.simulator import AvatarsimEngine
from runfiles.visible_motion import reversals, shaking
from scenarios import unseen

Array = NDArray[np.float64]
DT = 1.0 / 60.0


def drawn(seed: int) -> tuple[Scene, list[TrackerSample]]:
    """A scene with an endless wall within reach, and a motion drawn by the seed that leads beyond it."""
    scenario = unseen.get("unseen_wall").as_run(full=False)
    scene = scenario.build()
    motion = scenario.motion(scene, seed)
    return scene, [motion(k) for k in range(scenario.frames)]


def shown(scene: Scene, samples: list[TrackerSample], dt: float = DT) -> Array:
    """Link origins (F+1, L, 3) of the states shown."""
    engine = AvatarsimEngine()
    first = engine.load(scene, Settings(), dt)
    records = [first, *(engine.advance(sample, dt) for sample in samples)]
    return np.array([record.shown.positions[len(scene.bodies) :] for record in records])


@pytest.mark.parametrize("frame", [320, 393, 460])
def test_before_a_user_who_holds_still_beyond_a_wall_limbs_come_to_rest(frame: int) -> None:
    """Without the curvature of contact forces the arms went on to swing by 20 to 130 mm a frame."""
    scene, samples = drawn(5)
    places = shown(scene, samples[:frame] + [samples[frame - 1]] * 90)
    user, _ = link_poses_each(scene.avatars, [samples[frame - 1]])
    assert np.linalg.norm(places[frame] - user[0], axis=-1).max() > 0.4, "something has to be in the way"
    ways = np.linalg.norm(np.diff(places[-60:], axis=0), axis=-1)
    assert ways.max() < 0.015 and ways[-10:].max() < 5e-3
    assert not shaking(reversals(places[-60:], np.repeat(user, 60, axis=0)), DT).any()


@pytest.mark.parametrize("slower", [1, 4])
def test_limbs_at_a_wall_do_not_go_to_and_fro_while_the_user_moves(slower: int) -> None:
    """Of six seconds, in most of which the user is beyond the wall, they shook in a third."""
    scene, samples = drawn(5)
    roots = np.array([sample.positions[0] for sample in samples])
    part = samples[180:480]
    if slower > 1:
        # the same places, each held while the root goes a part of the way to the next
        part = [
            replace(sample, positions=sample.positions + np.eye(len(sample.positions))[:, :1] * (k / slower) * (after - before))
            for sample, before, after in zip(samples[180:255], roots[180:255], roots[181:256], strict=True)
            for k in range(slower)
        ]
    places = shown(scene, samples[:180] + part)
    user, _ = link_poses_each(scene.avatars, [samples[179], *part])
    assert np.mean(shaking(reversals(places[180:], user), DT)) < 0.03
