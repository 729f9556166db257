"""Tracked links have no weight in the tuned engines, in any orientation, and recording inside a frame changes no result."""

import numpy as np
import pytest

from avatarsim.engine import Engine, Settings
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.joint import Free
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from scenarios.job import Job
from scenarios.run.accuracy import prepare
from tests.agreement.rivals import ENGINES, PybulletEngine, needs_pybullet
from tests.agreement.runs import played
from tests.agreement.scenes import every_joint, posture, skewed, turned

BALL = (Piece(Sphere(0.1)),)
LIMP = {"root_force": 0.0, "hand_force": 0.0, "hinge_force": 0.0, "ball_force": 0.0, "limit_force": 0.0, "ball_limits": False}
"""Settings of PyBullet without any drive of a link; the ball of the first avatar is beyond its limits."""


def beside_a_falling_ball(avatar: Avatar, start: TrackerSample) -> Scene:
    """Return a scene in which a ball falls far from the avatar, so that there is gravity."""
    loose = simulated("ball", BALL, "wood", solid(BALL, 0.2), (9.0, 0.0, 9.0))
    return Scene("held", (loose,), (avatar,), start=start)


JOINTED = Avatar("jointed", tuple(link for link in every_joint().links if link.name in ("root", "one", "ball")))
"""The avatar without links that overlap at the start, and without those that PyBullet makes into a chain of light links."""


@needs_pybullet
@pytest.mark.parametrize("avatar", [JOINTED, Avatar("hand", (Link("hand", None, Free(), BALL, skewed(1.0, 5)),))])
def test_a_turned_link_that_nobody_drives_stays_where_it_is(avatar: Avatar) -> None:
    start = posture(avatar, 3)
    start.rotations[0] = turned(8)
    records = played(PybulletEngine(), beside_a_falling_ball(avatar, start), [start] * 20, Settings("tuned", LIMP))
    first, shown = records[0].shown, records[-1].shown
    assert shown.positions[0, 2] < first.positions[0, 2] - 0.4
    # all axes are checked: a force that turns with the link would push it sideways
    assert np.abs(shown.positions[1:] - first.positions[1:]).max() < 1e-6
    assert np.abs(shown.orientations[1:] - first.orientations[1:]).max() < 1e-6


@ENGINES
@pytest.mark.parametrize("preset", ["default", "tuned"])
@pytest.mark.parametrize("scene", ["ball_off_table", "hand_over_table", "squeeze"])
def test_looking_inside_frames_changes_no_bit(engine: Engine, preset: str, scene: str) -> None:
    lasts = []
    for inside in (False, True):
        job = Job(scene, engine.name, preset, frames=12)
        prepared = prepare(job)
        scenario, built, motion = prepared.scenario, prepared.scene, prepared.motion
        opened = type(engine)()
        samples = [motion(k) for k in range(12)]
        last = played(opened, built, samples, job.settings(opened, inside=inside), scenario.dt)[-1]
        lasts.append(last.state_hash())
        assert bool(last.inside) == inside
    assert lasts[0] == lasts[1]
