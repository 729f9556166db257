"""The judge inside scenes: the pairs it finds, names and leaves out, and its answers to invalid poses."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.errors import InvalidInput
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Mass, fixed, simulated
from avatarsim.scene.joint import Ball, Free
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere, ellipsoid_hull
from avatarsim.spatial import rotation
from reference.judging import judge as module
from reference.judging.judge import Judge

PROMISE = 1e-8


def limb(name, parent, anchor, joint):
    return Link(name, parent, joint, (Piece(ellipsoid_hull((0.1, 0.05, 0.05))),), Mass(1.0), anchor=anchor)


ARM = Avatar("arm", (limb("upper", None, (0, 0, 0), Free()), limb("fore", "upper", (0.15, 0, 0), Ball()),
                     limb("hand", "fore", (0.15, 0, 0), Ball()), limb("thumb", "hand", (0.0, 0.05, 0), Ball())),
             ignore=(("fore", "thumb"),))
ROOM = Scene("room", (
    fixed("table", (Piece(Box((1.0, 1.0, 0.1)), (0.0, 0.0, -0.05)),), "wood"),
    fixed("wall", (Piece(Box((0.1, 1.0, 1.0))),), "wood"),
    simulated("ball", (Piece(Sphere(0.1)),), "wood", Mass(1.0)),
    simulated("dumbbell", (Piece(Sphere(0.05), (0.1, 0, 0)), Piece(Sphere(0.05), (-0.1, 0, 0))), "metal", Mass(1.0)),
), (ARM,), exclude=(("ball", "wall"),))
FREE = np.array([[0, 0, 0], [0.3, 0, 0.2], [0, 0.3, 0.5], [0, -0.3, 0.5], [-2, 0, 1], [-2, 1, 1], [-2, 2, 1], [-2, 3, 1.0]])


def upright(positions):
    return np.tile(rotation.IDENTITY, (len(positions), 1))


def test_a_free_scene_is_free_and_names_its_gap():
    verdict = Judge(ROOM).overlaps(FREE, upright(FREE), reach=1.0)
    assert (verdict.deepest, verdict.pair, verdict.pairs, verdict.faults) == (0.0, None, (), ())
    # the wall's face is at x = 0.25, the dumbbell ends at x = 0.15
    assert verdict.gap == pytest.approx(0.1)
    assert Judge(ROOM).overlaps(FREE, upright(FREE)).gap == np.inf


@pytest.mark.parametrize("depth", [1e-6, 1e-3, 0.05])
def test_a_planted_overlap_is_found_with_its_depth_and_names(depth):
    at = FREE.copy()
    at[2] = 0.0, 0.3, 0.1 - depth
    verdict = Judge(ROOM).overlaps(at, upright(at))
    assert verdict.pair == ("table", "ball")
    assert verdict.deepest == pytest.approx(depth, abs=PROMISE)
    assert verdict.gap == pytest.approx(-depth, abs=PROMISE)
    assert [names for *names, _ in verdict.pairs] == [["table", "ball"]]


def test_the_deepest_piece_counts_and_pairs_come_deepest_first():
    at = FREE.copy()
    at[2] = 0.0, 0.3, 0.09
    # one end of the dumbbell is deeper in the table than the other
    tilt = upright(at)
    tilt[3] = rotation.from_axis_angle([0.0, 1.0, 0.0], 0.1)
    at[3] = 0.0, -0.3, 0.05
    verdict = Judge(ROOM).overlaps(at, tilt)
    assert [pair[:2] for pair in verdict.pairs] == [("table", "ball"), ("table", "dumbbell")]
    assert [pair[2] for pair in verdict.pairs] == pytest.approx([0.01, 0.1 * np.sin(0.1)], abs=PROMISE)


def test_only_pairs_that_the_scene_filters_in_are_judged():
    inside = FREE.copy()
    # fixed in fixed, the excluded pair, a link in its parent, and an ignored pair
    inside[1] = inside[0]
    assert Judge(ROOM).overlaps(inside, upright(inside)).deepest == 0.0
    for moved, onto in ((2, 1), (5, 4), (7, 5)):
        at = FREE.copy()
        at[moved] = at[onto]
        assert Judge(ROOM).overlaps(at, upright(at)).deepest == 0.0
    at = FREE.copy()
    at[6] = at[4]
    assert Judge(ROOM).overlaps(at, upright(at)).pair == ("arm/upper", "arm/hand")


def test_every_pair_is_found_that_a_look_at_all_pairs_finds():
    rng = np.random.default_rng(23)
    judge = Judge(ROOM)
    for _ in range(50):
        at = rng.uniform(-0.3, 0.3, (8, 3))
        turns = rotation.normalised(rng.normal(size=(8, 4)))
        everything = judge.distances(at, turns, reach=100.0)
        want = {(min(a, b), max(a, b)): d for a, b, d in zip(*everything, strict=True) if d < 0.0}
        got = {(min(a, b), max(a, b)): d for a, b, d in zip(*judge.distances(at, turns), strict=True) if d < 0.0}
        assert got == pytest.approx(want)
        owners = judge.pieces.owner
        allowed = sum(ROOM.pair_filter[a, b] for i, a in enumerate(owners) for b in owners[i + 1:])
        assert len(everything[0]) == allowed


def test_a_moved_and_rotated_world_gives_the_same_verdict():
    rng = np.random.default_rng(29)
    judge = Judge(ROOM)
    for _ in range(30):
        at, turns = rng.uniform(-0.3, 0.3, (8, 3)), rotation.normalised(rng.normal(size=(8, 4)))
        turn, shift = rotation.normalised(rng.normal(size=4)), rng.normal(size=3) * 10.0
        here = judge.overlaps(at, turns)
        there = judge.overlaps(rotation.rotate(turn, at) + shift, rotation.multiply(turn, turns))
        assert there.deepest == pytest.approx(here.deepest, abs=PROMISE)
        assert {frozenset(pair[:2]) for pair in there.pairs if pair[2] > PROMISE} \
            == {frozenset(pair[:2]) for pair in here.pairs if pair[2] > PROMISE}


@pytest.mark.parametrize(("body", "place", "turn"), [
    ("ball", (0.0, np.nan, 0.0), rotation.IDENTITY), ("arm/hand", (0.0, 0.0, np.inf), rotation.IDENTITY),
    ("table", (0.0, -np.inf, 0.0), rotation.IDENTITY), ("dumbbell", (0.0, 0.0, -1e300), rotation.IDENTITY),
    ("dumbbell", (0.0, 0.0, 1e8), rotation.IDENTITY),
    *(("dumbbell", (0.0, -0.3, 0.5), turn) for turn in ((np.nan, 0, 0, 0), (0, 0, 0, 0), (1.001, 0, 0, 0), (0.7, 0.7, 0, 0.01))),
])
def test_a_pose_not_finite_gives_a_depth_that_fails(body, place, turn):
    at, turns = FREE.copy(), upright(FREE)
    at[ROOM.names.index(body)], turns[ROOM.names.index(body)] = place, turn
    verdict = Judge(ROOM).overlaps(at, turns)
    assert np.isnan(verdict.deepest) and not verdict.deepest <= 1.0
    assert len(verdict.faults) == 1 and body in verdict.faults[0]


def test_a_quaternion_off_by_rounding_is_accepted_and_normalised():
    at, turns = FREE.copy(), upright(FREE)
    at[3] = 0.0, -0.3, 0.09
    turns[3] = rotation.from_axis_angle([0.0, 1.0, 0.0], 0.5 * np.pi)
    # the dumbbell is upright on its end; scaled by the quaternion's square its arm would be 1e-7 m longer
    assert Judge(ROOM).overlaps(at, turns * (1.0 + 5e-7)).deepest == pytest.approx(0.06, abs=PROMISE)


@pytest.mark.parametrize("shapes", [((7, 3), (8, 4)), ((8, 3), (8, 3)), ((8,), (8, 4))])
def test_poses_that_do_not_fit_the_scene_are_refused(shapes):
    with pytest.raises(InvalidInput):
        Judge(ROOM).overlaps(np.ones(shapes[0]), np.ones(shapes[1]))


def test_the_same_poses_give_the_same_bits():
    rng = np.random.default_rng(31)
    at, turns = rng.uniform(-0.3, 0.3, (8, 3)), rotation.normalised(rng.normal(size=(8, 4)))
    judge = Judge(ROOM)
    before = judge.overlaps(at, turns)
    judge.overlaps(FREE, upright(FREE))
    assert judge.overlaps(at, turns) == before == Judge(ROOM).overlaps(at, turns)


def test_many_states_at_once_are_judged_as_each_alone(monkeypatch):
    monkeypatch.setattr(module, "PLACED_AT_ONCE", 20)
    random = np.random.default_rng(3)
    places = FREE + 0.3 * random.normal(size=(40, *FREE.shape))
    turns = rotation.normalised(random.normal(size=(40, len(FREE), 4)))
    places[7, 2] = np.nan
    judge = Judge(ROOM)
    together, alone = judge.each(places, turns), [judge.overlaps(p, q) for p, q in zip(places, turns, strict=True)]
    assert [repr(verdict) for verdict in together] == [repr(verdict) for verdict in alone]
    depths = judge.depths(places, turns)
    assert np.isnan(depths[7]) and (depths[np.arange(40) != 7] >= 0.0).all() and (depths > 0.0).any()
    linked = judge.link_depths(places, turns)
    assert (linked[np.arange(40) != 7] <= depths[np.arange(40) != 7]).all() and (linked < depths).any()


def test_a_pair_without_a_distance_is_never_a_pass(monkeypatch):
    at = FREE.copy()
    at[2] = 0.0, 0.3, 0.09
    judge = Judge(ROOM)
    monkeypatch.setattr(judge.between, "each", lambda at, turned, near: (np.nan * near.state, np.zeros(len(near.state), bool)))
    verdict = judge.overlaps(at, upright(at))
    assert np.isnan(verdict.deepest)
    assert "table" in verdict.faults[0]
    assert np.isnan(judge.depths(at[None], upright(at)[None])[0]) and np.isnan(judge.deepest(at[None], upright(at)[None]))


def test_gaps_of_links_go_to_the_reach_and_below_0_inside():
    judge = Judge(ROOM)
    at = np.tile(FREE, (4, 1, 1))
    # the arm's first link above the table's face, into it, far from all, and no number
    at[:, 4] = (-0.3, 0.0, 0.054), (-0.3, 0.0, 0.04), (-2.0, 0.0, 1.0), (np.nan, 0.0, 1.0)
    turned = np.tile(rotation.IDENTITY, (4, len(FREE), 1))
    gaps = judge.link_gaps(at, turned, 5e-3)
    assert gaps[:2] == pytest.approx([judge.overlaps(at[k], turned[k], 5e-3).gap for k in (0, 1)], abs=PROMISE)
    assert 0.0 < gaps[0] < 5e-3 and gaps[1] < -5e-3 and gaps[2] == np.inf and np.isnan(gaps[3])
    # the ball comes near the table without a link
    at[2, 2] = 0.0, 0.3, 0.101
    assert judge.link_gaps(at[2:3], turned[2:3], 5e-3)[0] == np.inf
    assert judge.overlaps(at[2], turned[2], 5e-3).gap == pytest.approx(1e-3, abs=PROMISE)


def resting(depth):
    """Return the arm without its `ignore`, whose fore and thumb may be `depth` [m] in each other, and the thumb in the table."""
    arm = replace(ARM, ignore=(), at_rest=(("fore", "thumb", depth),))
    return replace(ROOM, avatars=(arm,), at_rest=(("arm/thumb", "table", 0.5 * depth),))


@pytest.mark.parametrize("depth", [0.01, 0.08])
def test_pairs_that_overlap_at_home_overlap_beyond_that(depth):
    at = FREE.copy()
    # thumb in fore: hulls of two ellipsoids with semi-axes of 50 mm along z
    at[7] = at[5] + (0.0, 0.0, 0.1 - 0.03)
    raw = Judge(resting(0.0)).overlaps(at, upright(at), reach=1.0)
    found = Judge(resting(depth)).overlaps(at, upright(at), reach=1.0)
    assert raw.pair == ("arm/fore", "arm/thumb") and raw.deepest == pytest.approx(0.03, abs=5e-3)
    assert found.deepest == pytest.approx(max(0.0, raw.deepest - depth), abs=PROMISE)
    assert (found.pair is None) == (depth > raw.deepest)
    states = np.array([at, FREE, at]), np.array([upright(at)] * 3)
    assert Judge(resting(depth)).depths(*states) == pytest.approx([found.deepest, 0.0, found.deepest], abs=PROMISE)
    assert Judge(resting(depth)).deepest(*states) == pytest.approx(found.deepest, abs=PROMISE)
    at[7] = 0.0, 0.0, 0.05 - 0.75 * depth
    flat, sunk = (Judge(resting(allowed)).overlaps(at, upright(at)).deepest for allowed in (0.0, depth))
    assert flat == pytest.approx(0.75 * depth, abs=2e-3) and sunk == pytest.approx(flat - 0.5 * depth, abs=PROMISE)


def test_other_engines_leave_pairs_out_that_overlap_at_home():
    scene = resting(0.01)
    index = {name: k for k, name in enumerate(scene.names)}
    for a, b in (("arm/fore", "arm/thumb"), ("arm/thumb", "table")):
        assert scene.pair_filter[index[a], index[b]] and not scene.contact_filter[index[a], index[b]]
    assert (scene.contact_filter <= scene.pair_filter).all() and scene.contact_filter.sum() == scene.pair_filter.sum() - 4
