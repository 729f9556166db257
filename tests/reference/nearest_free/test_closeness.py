"""The two figures against the measures of recordings, and their slopes against differences."""

import numpy as np
import pytest

from reference.nearest_free.closeness import Closeness
from reference.nearest_free.tree import Tree, posture_of
from scenarios.measure.posture.tracker_offset import angle_offsets, offsets
from tests.reference.nearest_free.arm import mixed, planar_arm, posed, wall_scene
from tests.scenarios.examples import recorded

SCENE = wall_scene(mixed(), planar_arm())
TREE = Tree(SCENE)


@pytest.mark.parametrize("seed", range(4))
def test_figures_are_those_of_the_measures(seed):
    random = np.random.default_rng(seed)
    user, shown = posed(SCENE, random), posed(SCENE, random)
    recording, other = recorded(SCENE, [user, user]), recorded(SCENE, [shown, shown])
    recording.positions[:], recording.orientations[:] = other.positions, other.orientations
    found = Closeness(TREE, TREE.placed(posture_of(user)), 0.2).figures(TREE.placed(posture_of(shown)))
    measured = [np.sqrt(np.mean(v**2)) for v in (offsets(recording), angle_offsets(recording, SCENE))]
    assert found == pytest.approx(measured, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_the_linearised_score_is_a_difference(seed):
    random = np.random.default_rng(seed)
    closeness = Closeness(TREE, TREE.placed(posture_of(posed(SCENE, random))), 0.2)
    posture = TREE.clipped(posture_of(posed(SCENE, random, 0.2)))
    rates, error = closeness.linearised(TREE.placed(posture))
    assert error @ error == pytest.approx(closeness.score(TREE.placed(posture)), abs=1e-12)
    slope = 2.0 * rates.T @ error
    for j in range(TREE.n):
        ends = [closeness.score(TREE.placed(TREE.moved(posture, h * np.eye(TREE.n)[j]))) for h in (-1e-6, 1e-6)]
        assert slope[j] == pytest.approx((ends[1] - ends[0]) / 2e-6, abs=1e-7)
