"""Postures that the engine shows in contact, against the nearest free ones."""

from dataclasses import replace

import numpy as np

from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog
from tests.nearest_free.search import Problem, nearest, scattered
from tests.nearest_free.tree import Tree, posture_of

FRAMES = 250
CHOSEN = (200, 245)
"""Frames in which the arm is pressed into the corner."""
SPREADS = (0.05, 0.15, 0.4)
"""Standard deviations of random starts [rad]."""


def test_an_arm_in_a_corner_is_within_twice_the_nearest() -> None:
    scenario = replace(catalog.get("arm_in_corner").as_run(False), frames=FRAMES)
    scene = scenario.build()
    motion, tree, bodies = scenario.motion(scene, 0), Tree(scene), len(scene.bodies)
    free = np.full((len(scene.links), 3), np.inf)
    engine = AvatarsimEngine()
    engine.load(scene, Settings(), scenario.dt)
    random, farthest = np.random.default_rng(1), 0.0
    for k in range(FRAMES):
        sample = motion(k)
        frame = engine.advance(sample, scenario.dt)
        if k not in CHOSEN:
            continue
        at, turns = frame.shown.positions, frame.shown.orientations
        user, shown = posture_of(sample), tree.from_poses(at[bodies:], turns[bodies:], frame.angles)
        problem = Problem(scene, tree, at[:bodies], turns[:bodies], user, -free, free)
        starts = [shown, user, *(scattered(tree, shown, spread, random) for spread in SPREADS)]
        best, own = nearest(problem, starts), problem.found(shown)
        assert best is not None and best.score <= own.score + 1e-10
        assert own.offset <= 2.0 * best.offset + 1e-3
        farthest = max(farthest, best.offset)
    # the user is inside the wall in one of these frames at least
    assert farthest > 1e-3
