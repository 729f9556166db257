"""Frames of method `ik` through its arena against the same kernel on plain arrays: every bit is the same."""

import numpy as np
import pytest

from avatarsim.ik.solve import solve
from avatarsim.loops.ik_loop import NOT_KNOWN, IkLoop
from avatarsim.settings import Chosen
from avatarsim.world.target import Target
from avatarsim.world.world import build, posture_of
from tests.ik.scenes import SCENES, drawn
from tests.ik.solvers import solver_of
from tests.world.test_arena import leaves


@pytest.mark.parametrize("name", ["two", "hinged"])
def test_frames_through_arenas_are_the_same_to_the_last_bit(name: str) -> None:
    scene, chosen = SCENES[name], Chosen()
    apart, world = solver_of(scene), build(scene)
    target, lower = Target(world), IkLoop(world, chosen.ik, chosen.coupling)
    lower.watch(NOT_KNOWN)
    worked = 0
    for sample in drawn(scene, 11, 40):
        target.read(sample)
        lower.follow(target, 1.0 / 60.0)
        w = apart.world
        solve(
            w.geometry, w.skeleton, apart.avatars, chosen.ik, posture_of(w.skeleton, w.hinges, sample), 1.0 / 60.0, NOT_KNOWN,
            w.posture, w.poses, apart.state, apart.working,
        )
        plain, packed = leaves((w.posture, w.poses, apart.state)), leaves((world.posture, world.poses, lower.state))
        for one, other in zip(plain, packed, strict=True):
            assert np.asarray(one).tobytes() == np.asarray(other).tobytes()
        worked += lower.counts()["rows"]
    assert worked > 0
