"""Target of a frame, clipped joint by joint, and the budgets that its motion opens; the memory of pairs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.ik.broad_phase import form_islands
from avatarsim.ik.constraints import touch
from avatarsim.ik.motion_budget import AT_REST
from avatarsim.ik.state import PROBES, axis_at, forget_pairs, keep_axis, make_pair_cache, slot_of
from avatarsim.ik.target import clip_to_limits, open_budgets
from avatarsim.model.joint_limits import cone_excess
from avatarsim.model.skeleton import BALL, Posture
from avatarsim.model.world import posture_of
from avatarsim.settings import PostureSettings
from avatarsim.spatial.tangent import columns
from tests.ik.solvers import TREES, Solver, copied, solver_of
from tests.worlds.little_worlds import random_sample

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
DT = 1.0 / 60.0
SETTINGS = PostureSettings()


def clipped(found: Solver, tracker: Posture) -> Posture:
    """Return the clipped target of all avatars."""
    clip_to_limits(found.rig, tracker, found.state.tracking, found.working.target)
    return copied(found.working.target)


def met(found: Solver, tracker: Posture, has_changed: bool = False) -> np.ndarray:
    """Begin a frame with that target: the budget of each joint's turn, beyond the target's own turn."""
    clipped(found, tracker)
    form_islands(found.rig, found.state, found.working)
    open_budgets(found.rig, SETTINGS, tracker, DT, has_changed, found.state, found.working)
    return found.state.budget.turn.copy()


@given(st.integers(0, 10**6))
def test_a_target_is_the_trackers_where_that_is_within_limits(seed: int) -> None:
    found = solver_of(TREES)
    skel = found.world.skeleton
    tracker = posture_of(skel, found.world.hinges, random_sample(TREES.avatars, seed))
    target = clipped(found, tracker)
    assert (target.root == tracker.root).all()
    at = found.world.hinges
    assert (target.angle[at] == np.clip(tracker.angle[at], skel.limits[at, 0], skel.limits[at, 1])).all()
    legal = np.ones(found.count, dtype=bool)
    for link in range(len(skel.kind)):
        beyond = skel.kind[link] == BALL and cone_excess(skel.balls, link, columns(tracker.turn, link)) > 0.0
        if beyond:
            legal[found.avatars.avatar[link]] = False
            assert cone_excess(skel.balls, link, columns(target.turn, link)) <= 1e-12
        else:
            assert target.turn[link] == pytest.approx(tracker.turn[link], abs=1e-15)
    for a in range(found.count):
        mine = slice(found.avatars.first_dof[a], found.avatars.first_dof[a + 1])
        legal[a] &= bool((target.angle[mine] == tracker.angle[mine]).all())
    assert (found.state.tracking.is_legal == legal).all()
    again = clipped(found, target)
    assert again.turn == pytest.approx(target.turn, abs=1e-12) and (again.angle == target.angle).all()


def test_a_resting_target_opens_less_and_less() -> None:
    found = solver_of(TREES)
    start = copied(found.world.posture)
    gone = copied(start)
    gone.root[0, 0] += 0.01
    whole = SETTINGS.catch_up_turn * DT
    assert (met(found, start) == 0.0).all(), "nothing has moved yet"
    assert met(found, gone)[:5] == pytest.approx(whole)
    first = 0.01 / DT
    for k in range(1, 400):
        wanted = whole * min(1.0, first * np.exp(-k * DT / SETTINGS.settle_time) / AT_REST)
        assert met(found, gone)[:5] == pytest.approx(wanted, rel=1e-9)
    assert wanted < 1e-3 * whole
    assert met(found, gone, has_changed=True) == pytest.approx(whole), "what moved may have set an avatar free"


def test_a_moving_target_frees_those_that_touch_its_avatar() -> None:
    """It may free avatars that its avatar held; one far away has nothing to do with it."""
    found = solver_of(TREES)
    first = found.avatars.first_link[:-1].tolist()
    start, whole = copied(found.world.posture), SETTINGS.catch_up_turn * DT
    met(found, start)
    gone = copied(start)
    gone.root[0, 0] += 0.01
    assert met(found, gone)[first] == pytest.approx([whole, 0.0, 0.0])
    geo, skel = found.world.geometry, found.world.skeleton
    one, other = (int(geo.first_shape[skel.first + link]) for link in first[:2])
    touch(one, other, found.state.touching)
    gone.root[0, 0] += 0.01
    assert met(found, gone)[first] == pytest.approx([whole, whole, 0.0])
    found.state.touching.used[0] = 0
    assert met(found, gone)[first] == pytest.approx([whole, whole, 0.0]), "set free, it goes on"


def test_a_target_beyond_a_cone_opens_what_the_tracker_turned() -> None:
    """Where a small turn of the tracker sends the clipped target round the cone, the smaller of both counts."""
    rng = np.random.default_rng(2)
    whole = SETTINGS.catch_up_turn * DT
    more = 0
    for seed in range(40):
        found = solver_of(TREES)
        before = posture_of(found.world.skeleton, found.world.hinges, random_sample(TREES.avatars, seed))
        met(found, before)
        after = copied(before)
        ball = int(np.flatnonzero(found.world.skeleton.kind == BALL)[0])
        old = columns(found.working.target.turn, ball)
        axis = rng.normal(size=3)
        angle = 0.3
        c, s, n = np.cos(angle), np.sin(angle), axis / np.linalg.norm(axis)
        cross = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
        after.turn[ball] = before.turn[ball] @ (np.eye(3) + s * cross + (1.0 - c) * cross @ cross)
        budget = met(found, after)
        new = columns(found.working.target.turn, ball)
        turned = np.arccos(np.clip(0.5 * (np.trace(np.array(old) @ np.array(new).T) - 1.0), -1.0, 1.0))
        more += turned > angle + 1e-6
        assert budget[ball] <= angle + whole + 1e-9
        assert budget[ball] == pytest.approx(min(turned, angle) + whole, abs=1e-6)
    assert more > 2, "in some the clipped target went farther than the tracker"


PIECES = 5000
PAIRS = st.tuples(st.integers(0, PIECES - 1), st.integers(0, PIECES - 1))


@given(st.lists(st.tuples(PAIRS, st.booleans(), st.booleans()), max_size=400))
def test_what_is_known_of_a_pair_is_what_was_kept_or_nothing(asked: list[tuple[tuple[int, int], bool, bool]]) -> None:
    cache, known = make_pair_cache(1, PIECES), dict[tuple[int, int], tuple[float, float, float]]()
    for k, (pair, keeps, is_next_step) in enumerate(asked):
        cache.step[0] += is_next_step
        at = slot_of(cache, *pair)
        assert cache.key[at] == pair[0] * PIECES + pair[1] and (cache.key == cache.key[at]).sum() == 1
        assert axis_at(cache, at) in (known.get(pair, (0.0, 0.0, 0.0)), (0.0, 0.0, 0.0))
        if keeps:
            known[pair] = (float(k), 1.0, -1.0)
            keep_axis(cache, at, known[pair])
            assert cache.axis_step[at] == -1


@given(st.sets(PAIRS, max_size=PROBES), st.integers(1, 40))
def test_as_many_pairs_as_are_looked_at_are_all_remembered(pairs: set[tuple[int, int]], driven: int) -> None:
    cache = make_pair_cache(driven, PIECES)
    for k, pair in enumerate(sorted(pairs)):
        keep_axis(cache, slot_of(cache, *pair), (float(k), 0.0, 1.0))
    for k, pair in enumerate(sorted(pairs)):
        assert axis_at(cache, slot_of(cache, *pair)) == (float(k), 0.0, 1.0)


def test_a_pair_used_in_every_step_is_never_forgotten() -> None:
    cache, rng = make_pair_cache(1, PIECES), np.random.default_rng(1)
    keep_axis(cache, slot_of(cache, 3, 7), (0.0, 0.0, 1.0))
    for step in range(500):
        cache.step[0] = step
        slot_of(cache, *rng.integers(PIECES, size=2).tolist())
        assert axis_at(cache, slot_of(cache, 3, 7)) == (0.0, 0.0, 1.0)


def test_the_pair_unused_for_longest_is_given_up() -> None:
    cache, rng = make_pair_cache(1, PIECES), np.random.default_rng(0)
    for step in range(200):
        cache.step[0] = step
        pair = rng.integers(PIECES, size=2).tolist()
        before, keys = cache.used.copy(), cache.key.copy()
        at = slot_of(cache, *pair)
        if keys[at] not in (-1, cache.key[at]):
            # each of the slots looked at was used in another step
            assert step - before[at] >= PROBES
    assert (cache.key >= 0).all()
    forget_pairs(cache)
    assert (cache.key == -1).all()


def test_a_pair_that_comes_anew_into_a_slot_knows_nothing() -> None:
    cache = make_pair_cache(1, PIECES)
    cache.axis[:], cache.axis_step[:], cache.gap_step[:] = 1.0, 0, 0
    at = slot_of(cache, 3, 7)
    assert axis_at(cache, at) == (0.0, 0.0, 0.0) and cache.axis_step[at] == -1 and cache.gap_step[at] == -1
