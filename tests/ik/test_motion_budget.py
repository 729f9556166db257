"""The motion budget of a frame: the budget that is opened, a step's part of it, and the part that is spent."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.ik.kinematics import parts_of
from avatarsim.ik.motion_budget import AT_REST, bound_step, keep_budget, open_budget, spend
from avatarsim.model.skeleton import FREE, HINGES, SLIDE
from avatarsim.settings import PostureSettings
from tests.ik.solvers import TREES, Solver, random_posture, solver_of

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
SETTINGS, DT = PostureSettings(catch_up_turn=10.0, catch_up_move=4.0), 1.0 / 60.0
FOUND = solver_of(TREES)
ND, LINKS = len(FOUND.avatars.joint_of), range(len(FOUND.world.skeleton.kind))


def opened(speed: float, clipped: np.ndarray, own: np.ndarray) -> Solver:
    """Return the budgets of all avatars in a frame."""
    for avatar in range(FOUND.count):
        open_budget(FOUND.rig, avatar, SETTINGS, DT, speed, own, clipped, FOUND.state.budget)
    return FOUND


@given(st.integers(0, 10**6), st.floats(0.0, 1.0))
def test_a_budget_is_own_motion_and_a_share_of_catch_up_speed(seed: int, speed: float) -> None:
    rng = np.random.default_rng(seed)
    clipped, own = rng.normal(size=ND), rng.normal(size=ND)
    followed = clipped.copy()
    budget, share = opened(speed, followed, own).state.budget, min(1.0, speed / AT_REST) * DT
    for link in LINKS:
        moved, turned = parts_of(FOUND.world.skeleton, link, clipped)
        _, by_own = parts_of(FOUND.world.skeleton, link, own)
        assert parts_of(FOUND.world.skeleton, link, followed) == pytest.approx((moved, min(turned, by_own)))
        assert budget.move[link] == pytest.approx(moved + 4.0 * share)
        assert budget.turn[link] == pytest.approx(min(turned, by_own) + 10.0 * share)
        assert budget.moved[link] == budget.turned[link] == 0.0


@given(st.integers(0, 10**6), st.booleans(), st.floats(0.01, 3.0))
def test_a_frame_of_many_steps_goes_no_farther_than_the_budget(seed: int, has_slack: bool, by: float) -> None:
    rng = np.random.default_rng(seed)
    found = opened(1.0, 0.1 * rng.normal(size=ND), 0.1 * rng.normal(size=ND))
    skel, budget, path = found.world.skeleton, found.state.budget, np.zeros((len(LINKS), 2))
    for _ in range(5):
        step = by * rng.normal(size=ND)
        asked = step.copy()
        for avatar in range(found.count):
            keep_budget(found.rig, avatar, budget, has_slack, step)
            spend(found.rig, avatar, step, budget)
        path += [parts_of(skel, link, step) for link in LINKS]
        for link in LINKS:
            mine = slice(skel.first_dof[link], skel.first_dof[link + 1])
            # in the direction of the target
            assert (np.abs(step[mine]) <= np.abs(asked[mine])).all() and (step[mine] * asked[mine] >= 0.0).all()
    slack = budget.slack if has_slack else np.zeros(2)
    assert (path[:, 0] <= budget.move + slack[0] + 1e-12).all()
    assert (path[:, 1] <= budget.turn + slack[1] + 1e-12).all()


@given(st.integers(0, 10**6))
def test_what_is_within_the_budget_is_taken_whole(seed: int) -> None:
    rng = np.random.default_rng(seed)
    step = rng.normal(size=ND)
    found, kept = opened(0.0, step, step), step.copy()
    for avatar in range(found.count):
        keep_budget(found.rig, avatar, found.state.budget, False, kept)
    assert (kept == step).all()


@given(st.integers(0, 10**6))
def test_bounds_are_the_budget_left_and_hinge_limits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    found = opened(1.0, 0.2 * rng.normal(size=ND), 0.2 * rng.normal(size=ND))
    found.take(random_posture(found, seed))
    skel, s, posture = found.world.skeleton, found.working, found.world.posture
    # one hinge is beyond its limit by rounding
    posture.angle[found.world.hinges[0]] = np.nextafter(skel.limits[found.world.hinges[0], 1], 9.0)
    found.state.budget.turned[:] = rng.uniform(0.0, 0.5, len(LINKS))
    for avatar in range(found.count):
        bound_step(found.rig, avatar, posture, found.state.budget, s)
    assert (s.low <= 0.0).all() and (s.high >= 0.0).all()
    for link in LINKS:
        d, last = skel.first_dof[link], skel.first_dof[link + 1]
        if skel.kind[link] == FREE:
            assert s.high[d : d + 3] == pytest.approx(found.state.budget.move[link])
            d += 3
        left = max(0.0, found.state.budget.turn[link] - found.state.budget.turned[link])
        if skel.kind[link] == SLIDE:
            left = found.state.budget.move[link]
        assert (s.high[d:last] <= left + 1e-15).all() and (s.low[d:last] >= -left - 1e-15).all()
        for j in range(d, last) if skel.kind[link] in (HINGES, SLIDE) else ():
            inside = np.array([posture.angle[j] + s.low[j], posture.angle[j] + s.high[j]])
            assert (inside >= skel.limits[j, 0] - 1e-12).all() and (inside <= skel.limits[j, 1] + 1e-12).all()
