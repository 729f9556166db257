"""How often python-fcl differs from the judge, and that brute force sides with the judge when it does."""

import numpy as np
import pytest

from avatarsim.scene.body import Mass, fixed, simulated
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere, ellipsoid_hull
from avatarsim.spatial import rotation
from reference.judging.in_fcl import fcl_distance, fcl_geometry
from reference.judging.judge import Judge
from reference.judging.second_opinion import second_opinion

CLUTTER = Scene("clutter", (
    fixed("table", (Piece(Box((1.0, 1.0, 0.06))),), "wood"),
    fixed("wall", (Piece(Box((0.1, 1.0, 1.0))),), "wood"),
    *(simulated(f"egg{k}", (Piece(ellipsoid_hull((0.1 + 0.02 * k, 0.15, 0.08))),), "human", Mass(1.0)) for k in range(6)),
    *(simulated(f"pill{k}", (Piece(Capsule(0.05, 0.1 + 0.1 * k)),), "human", Mass(1.0)) for k in range(3)),
    *(simulated(f"ball{k}", (Piece(Sphere(0.05 + 0.03 * k)),), "metal", Mass(1.0)) for k in range(3)),
    *(simulated(f"crate{k}", (Piece(Box((0.1, 0.2, 0.3))),), "wood", Mass(1.0)) for k in range(3)),
))


def states(count, spread, seed=41):
    rng = np.random.default_rng(seed)
    n = len(CLUTTER.names)
    return [(rng.uniform(-spread, spread, (n, 3)), rotation.normalised(rng.normal(size=(n, 4)))) for _ in range(count)]


def test_brute_force_sides_with_the_judge_wherever_fcl_differs(record_property):
    opinion = second_opinion(Judge(CLUTTER), states(60, 0.4))
    record_property("fcl_disagreement_rate", opinion.rate)
    assert opinion.asked > 2000
    assert opinion.judge_wrong == 0
    for found in opinion.disagreements:
        assert found.judged == pytest.approx(found.decided, abs=1e-8)
    assert opinion.overlapping <= 0.01 * opinion.asked
    # fcl is a second opinion only while it mostly agrees
    assert opinion.rate < 0.2


def test_a_wrong_judge_is_found_out():
    judge = Judge(CLUTTER)
    honest = judge.distances

    def lying(positions, orientations, reach=0.0):
        first, second, found = honest(positions, orientations, reach)
        return first, second, found + 1e-3

    judge.distances = lying
    opinion = second_opinion(judge, states(5, 0.4))
    assert opinion.rate > 0.9
    assert opinion.judge_wrong > 0.8 * opinion.asked


def test_states_without_poses_and_scenes_without_near_pairs_ask_nothing():
    at, turns = states(1, 0.4)[0]
    at[0, 0] = np.nan
    assert second_opinion(Judge(CLUTTER), [(at, turns)]).asked == 0
    far = np.arange(len(CLUTTER.names))[:, None] * np.array([10.0, 0.0, 0.0])
    opinion = second_opinion(Judge(CLUTTER), [(far, turns)])
    assert (opinion.asked, opinion.rate) == (0, 0.0)


@pytest.mark.parametrize(("shape", "touch"), [
    (Sphere(0.2), 0.2), (Capsule(0.1, 0.4), 0.3), (Box((0.2, 0.2, 0.4)), 0.2),
])
def test_fcl_measures_along_the_same_axes_and_units(shape, touch):
    ground = fcl_geometry(Box((4.0, 4.0, 2.0)))
    for height in (0.5, 0.25, 0.15):
        got = fcl_distance(fcl_geometry(shape), np.eye(3), np.array([0.0, 0.0, 1.0 + height]), ground, np.eye(3), np.zeros(3))
        # fcl itself is 0.4 mm off here; a wrong axis or unit would be centimetres
        assert got == pytest.approx(height - touch, abs=1e-3)
