"""Frames of method `default` through its arena against the same kernel on plain arrays: every bit is the same."""

import numpy as np
import pytest

from avatarsim.ik.solve import begin_frame, solve
from avatarsim.ik.state import Rig
from avatarsim.lower_loop import NOT_KNOWN, IkLoop, step_avatars
from avatarsim.model.world import Target, build, posture_of
from avatarsim.planner.follow_path import aim_along_paths
from avatarsim.planner.state import make_planner
from avatarsim.planner.supervisor import drop_paths, supervise
from avatarsim.settings import Chosen
from tests.ik.scenes import SCENES, drawn
from tests.ik.solvers import solver_of
from tests.jit.test_arena import leaves


@pytest.mark.parametrize("name", ["two", "hinged"])
def test_frames_through_arenas_are_the_same_to_the_last_bit(name: str) -> None:
    scene, chosen = SCENES[name], Chosen()
    apart, world = solver_of(scene), build(scene)
    target, lower = Target(world), IkLoop(world, chosen.posture, chosen.coupling)
    lower.set_moving(NOT_KNOWN)
    worked, w = 0, apart.world
    plan, planning_avatar = make_planner(
        w.geometry, w.skeleton, apart.avatars, apart.state, w.posture, w.poses, np.array(scene.gravity), 0
    )
    for sample in drawn(scene, 11, 40):
        target.read(sample)
        step_avatars(world.words, target.words, lower.words, 1.0 / 60.0, lower.begin())
        tracker, dt = posture_of(w.skeleton, w.hinges, sample), 1.0 / 60.0
        geo, skel, posture, poses = w.geometry, w.skeleton, w.posture, w.poses
        avatars, state, working = apart.avatars, apart.state, apart.working
        begin_frame(Rig(geo, skel, avatars), chosen.posture, tracker, dt, NOT_KNOWN, posture, poses, state, working)
        drop_paths(Rig(geo, skel, avatars), tracker, posture, poses, plan, planning_avatar, state, working)
        aim_along_paths(Rig(geo, skel, avatars), chosen.posture, dt, posture, poses, plan, state, working)
        solve(Rig(geo, skel, avatars), chosen.posture, posture, poses, state, working)
        supervise(Rig(geo, skel, avatars), chosen.posture, tracker, dt, posture, poses, plan, planning_avatar, state, working)
        plain = leaves((w.posture, w.poses, apart.state, plan))
        packed = leaves((world.posture, world.poses, lower.state, lower.plan))
        for one, other in zip(plain, packed, strict=True):
            assert np.asarray(one).tobytes() == np.asarray(other).tobytes()
        worked += lower.counts()["rows"]
    assert worked > 0
