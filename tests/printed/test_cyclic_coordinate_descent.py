"""CCD against closed forms: reach of a planar arm, shortfall, limits, the straight chain."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from avatarsim.model.joint_limits import cone_excess
from avatarsim.paper.ccd_ik import NO_GOAL, OUT_OF_SWEEPS, REACHED, SINGULAR, STUCK
from avatarsim.settings import PaperSettings
from avatarsim.spatial.tangent import columns
from tests.worlds.arms import BENDING, arm, limited_ball, planar, reach, three_axes, world_of

WIDE = (-10.0, 10.0)
TWO = (0.5, 0.3)
TWO_LINKS = world_of((arm(TWO, planar(WIDE, WIDE)),))
quick = hypothesis_settings(deadline=None, max_examples=60)


@quick
@given(st.floats(0.23, 0.77), st.floats(-3.1, 3.1), st.floats(0.2, 2.8), st.floats(-3.0, 3.0))
def test_two_links_reach_as_the_law_of_cosines_says(distance, bearing, elbow, shoulder):
    goal = distance * np.array([np.cos(bearing), np.sin(bearing), 0.0])
    found = reach(TWO_LINKS, TWO, goal, BENDING, np.array([shoulder, elbow]))
    assert found.status == REACHED
    assert found.measured <= 1.1e-9
    # two postures reach the goal: elbow to one side or the other
    cosine = (distance**2 - TWO[0] ** 2 - TWO[1] ** 2) / (2.0 * TWO[0] * TWO[1])
    assert np.cos(found.angles[1]) == pytest.approx(cosine, abs=1e-7)


@pytest.mark.parametrize(("distance", "lengths"), [(0.9, TWO), (2.0, TWO), (0.1, TWO), (1.0, (0.3, 0.2, 0.2))])
def test_a_goal_out_of_reach_is_missed_by_the_stated_shortfall(distance, lengths):
    world = world_of((arm(lengths, planar(*[WIDE] * len(lengths))),))
    goal = distance * np.array([np.cos(0.7), np.sin(0.7), 0.0])
    found = reach(world, lengths, goal, PaperSettings(tolerance=1e-9, sweeps=20000), np.linspace(0.4, 0.9, len(lengths)))
    missed = max(distance - sum(lengths), 2.0 * max(lengths) - sum(lengths) - distance)
    assert found.measured == pytest.approx(missed, abs=1e-6)
    assert found.status in (STUCK, OUT_OF_SWEEPS)
    assert found.left == pytest.approx(found.measured, abs=1e-12)


def test_hinge_limits_hold_exactly_for_ten_thousand_goals():
    lengths = (0.3, 0.25, 0.2)
    limits = np.array([[-0.7, 1.1], [0.0, 2.4], [-0.3, 0.3]])
    world = world_of((arm(lengths, planar(*[(low, high) for low, high in limits])),))
    rng, settings = np.random.default_rng(5), PaperSettings(sweeps=6)
    at_a_limit = 0
    for goal in rng.uniform(-1.2, 1.2, (10_000, 3)):
        angles = reach(world, lengths, goal, settings).angles
        assert (angles >= limits[:, 0]).all() and (angles <= limits[:, 1]).all()
        at_a_limit += bool(((angles == limits[:, 0]) | (angles == limits[:, 1])).any())
    # otherwise the limits were never active
    assert at_a_limit > 2000


def test_a_ball_stays_in_its_cone():
    lengths = (0.4, 0.3)
    world = world_of((arm(lengths, [limited_ball(), limited_ball()]),))
    rng, settings = np.random.default_rng(6), PaperSettings(sweeps=6)
    at_the_edge = 0
    for goal in rng.uniform(-0.9, 0.9, (2000, 3)):
        reach(world, lengths, goal, settings)
        excess = [cone_excess(world.skeleton.balls, link, columns(world.posture.turn, link)) for link in range(2)]
        assert max(excess) <= 0.0
        at_the_edge += max(excess) > -1e-8
    assert at_the_edge > 500


@pytest.mark.parametrize("joint", [three_axes(3.0), limited_ball()])
def test_three_axes_that_share_a_centre_reach_in_space(joint):
    lengths = (0.4, 0.3)
    world = world_of((arm(lengths, [joint, planar((0.0, 2.5))[0]]),))
    rng, worst = np.random.default_rng(7), 0.0
    for _ in range(30):
        world.posture.turn[:] = np.eye(3)
        start = np.full(int(world.skeleton.first_dof[-1]), 0.3)
        direction = np.array([1.0, *rng.uniform(-0.6, 0.6, 2)])
        goal = rng.uniform(0.45, 0.6) * direction / np.linalg.norm(direction)
        worst = max(worst, reach(world, lengths, goal, BENDING._replace(tolerance=1e-7, sweeps=3000), start).measured)
    assert worst <= 1.1e-7


@quick
@given(st.lists(st.floats(-2.5, 2.5), min_size=3, max_size=3), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_a_sweep_never_leads_away_from_the_goal(angles, x, y):
    lengths, goal = (0.3, 0.25, 0.2), np.array([x, y, 0.1])
    world = world_of((arm(lengths, planar((-1.0, 1.5), (-2.6, 2.6), (-2.6, 2.6))),))
    start = np.clip(angles, [-1.0, -2.6, -2.6], [1.5, 2.6, 2.6])
    left = np.inf
    for sweeps in range(5):
        found = reach(world, lengths, goal, PaperSettings(tolerance=1e-9, sweeps=sweeps), start)
        assert found.measured <= left + 1e-12
        left = found.measured


def test_a_straight_chain_is_reported_and_bends_its_way_out():
    goal = np.array([0.6, 0.0, 0.0])
    stuck = reach(TWO_LINKS, TWO, goal, angles=np.zeros(2))
    assert (stuck.status, stuck.sweeps) == (SINGULAR, 1)
    assert stuck.measured == pytest.approx(0.2)
    found = reach(TWO_LINKS, TWO, goal, BENDING, np.zeros(2))
    assert (found.status, found.bent) == (REACHED, True)


def test_a_stretched_chain_below_its_goal_is_not_singular():
    assert reach(TWO_LINKS, TWO, np.array([0.9, 0.0, 0.0]), angles=np.zeros(2)).status == STUCK


def test_a_goal_beside_the_hinge_plane_is_not_singular():
    found = reach(TWO_LINKS, TWO, np.array([0.8, 0.0, 0.05]), angles=np.zeros(2))
    assert found.status == STUCK
    assert found.measured == pytest.approx(0.05)


@pytest.mark.parametrize("limits", [(-2.0, 0.0), (0.0, 2.0)])
def test_a_straight_chain_bends_to_the_side_limits_allow(limits):
    world = world_of((arm(TWO, planar(WIDE, limits)),))
    found = reach(world, TWO, np.array([0.6, 0.0, 0.0]), BENDING, np.zeros(2))
    assert (found.status, found.bent) == (REACHED, True)
    assert limits[0] <= found.angles[1] <= limits[1]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_goal_that_is_no_number_changes_nothing(bad):
    start = np.array([0.3, 0.4])
    found = reach(TWO_LINKS, TWO, np.array([bad, 0.0, 0.0]), angles=start)
    assert found.status == NO_GOAL
    assert (found.angles == start).all()


def test_a_goal_at_the_joint_leaves_that_joint_alone():
    found = reach(TWO_LINKS, TWO, np.zeros(3), angles=np.array([0.3, 0.4]))
    assert found.measured == pytest.approx(TWO[0] - TWO[1], abs=1e-6)
    assert np.isfinite(found.angles).all()
