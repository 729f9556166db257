"""The search for a way out: its tree never holds more than it has room for."""

import numpy as np
import pytest

from avatarsim.kernel import config
from avatarsim.posture import way_search
from avatarsim.posture.look import look
from avatarsim.posture.way_memory import NODE, NODES, NODES_USED, OPEN, TRIES, make_way
from avatarsim.posture.way_search import AWAY_STEPS, HOME_STEPS, PATIENCE, begin_tree, search
from avatarsim.posture.workspace import NOW, Goal, ready_memory
from avatarsim.scene.scene import Scene
from avatarsim.settings import PostureSettings
from avatarsim.world.world import build
from tests.posture.little_worlds import mixed_avatar, panel

SETTINGS = PostureSettings()


@pytest.mark.nojit
@pytest.mark.skipif(not config.DISABLE_JIT, reason="only plain Python can be told what a step does")
@pytest.mark.parametrize("left", range(AWAY_STEPS + HOME_STEPS - 2, AWAY_STEPS + HOME_STEPS + 12, 3))
def test_the_longest_walk_fits_into_what_is_left_of_the_tree(left: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A walk that gets nearer with every step and never arrives takes all the steps that it may."""
    world = build(Scene("s", (panel(x=3.0),), (mixed_avatar(),)))
    geo, skel = world.geometry, world.skeleton
    memory = ready_memory(geo, skel, world.posture, world.poses, SETTINGS)
    way, far = make_way(geo, skel, world.posture, world.poses, memory, 0), [1e9]

    def nearer(goal: Goal) -> float:
        far[0] *= 0.9
        return far[0]

    for name, does in {
        "walk": lambda *rest: 0.1, "work_done": lambda *rest: 1,
        "aim": lambda *rest: (1.0, 1.0), "farthest": lambda goal: 1.0, "merit": nearer,
    }.items():
        monkeypatch.setattr(way_search, name, does)
    begin_tree(world.posture, world.poses, 1.0, way)
    way.state[NODES_USED], way.state[NODE], way.state[TRIES], way.state[OPEN] = NODES - left, -1, 2, 1
    most = []
    while len(most) < 4 * (AWAY_STEPS + HOME_STEPS):
        search(geo, skel, SETTINGS._replace(search_work=1), way)
        most.append(int(way.state[NODES_USED]))
    assert max(most) <= NODES and HOME_STEPS % PATIENCE == 0


def test_what_was_asked_of_the_shown_avatar_counts_as_nothing_known_of_the_unseen_one() -> None:
    world = build(Scene("s", (panel(x=0.8),), (mixed_avatar(),)))
    geo, skel = world.geometry, world.skeleton
    memory = ready_memory(geo, skel, world.posture, world.poses, SETTINGS)
    way = make_way(geo, skel, world.posture, world.poses, memory, 0)
    memory.goal.tracker.root[0] = 2.0, 0.0, 0.0
    memory.goal.full[0] = 2.0
    memory.goal.slow[0] = 3.0
    assert look(geo, skel, SETTINGS, world.posture, world.poses, memory, way)
    pairs = way.memory.pairs
    assert pairs.nearest_stamp.max() >= 0
    assert not np.any(pairs.nearest_stamp == pairs.marks[NOW]) and not np.any(pairs.axis_stamp == pairs.marks[NOW])
