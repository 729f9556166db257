"""Straight motions between postures: one proved free is free at a thousand places on it, one free by a little is proved."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.cleaning.chords import Chords
from avatarsim.ik.motion_ccd import DEPTH, common_ancestors
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, fixed, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, between, link_poses, rest
from avatarsim.spatial import rotation
from tests.worlds.little_worlds import X, Y, at, hand, sliding_avatar

SAMPLES = 1000
SHAPES = (
    Sphere(0.06), Capsule(0.03, 0.15), Box((0.1, 0.16, 0.05)), Ellipsoid((0.05, 0.07, 0.1)), ellipsoid_hull((0.05, 0.08, 0.04)),
)


def obstacles(rng: np.random.Generator) -> tuple[Body, ...]:
    """Return a few shapes of all kinds about the origin."""
    found = []
    for k in range(5):
        x, y, z = (float(v) for v in rng.uniform(-0.6, 0.6, 3))
        a, b, c, d = (float(v) for v in rotation.normalised(rng.normal(size=4)))
        found.append(fixed(f"body {k}", (Piece(SHAPES[int(rng.integers(len(SHAPES)))]),), "wood", (x, y, z), (a, b, c, d)))
    return tuple(found)


def two_postures(avatar: Avatar, rng: np.random.Generator, size: float) -> tuple[TrackerSample, TrackerSample]:
    """Return a posture at random, and another whose root and joints are elsewhere by about `size` [m, rad]."""
    links, hinges = len(avatar.links), avatar.hinge_count
    turns = rotation.normalised(rng.normal(size=(links, 4)))
    first = TrackerSample(0.0, rng.uniform(-0.5, 0.5, (links, 3)), turns, rng.normal(size=hinges))
    turned = rotation.multiply(first.rotations, rotation.from_rotation_vector(size * rng.normal(size=(links, 3))))
    moved = first.positions + size * rng.normal(size=(links, 3))
    return first, TrackerSample(1.0, moved, rotation.normalised(turned), first.angles + size * rng.normal(size=hinges))


def gaps_along(chords: Chords, before: TrackerSample, after: TrackerSample, shares: np.ndarray) -> np.ndarray:
    """Return, as a twin, the smallest signed distance at many places, by the interpolation of Motion and the query of frames."""
    arrays = ([getattr(one, name) for one in (before, after)] for name in ("time", "positions", "rotations", "angles"))
    motion = Motion(*(np.array(array) for array in arrays))
    return np.array([chords.nearest(motion.between(0, float(share)), 0.01)[0] for share in shares])


def scene_with(avatar: Avatar, bodies: tuple[Body, ...]) -> Scene:
    """Return the avatar far above the bodies; chords take any posture."""
    return Scene("ways", bodies, (avatar,), start=at(rest((avatar,)), (0.0, 0.0, 9.0)))


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.sampled_from((0.02, 0.1, 0.4)))
def test_what_is_proved_is_free_at_a_thousand_places(seed: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    avatar = sliding_avatar() if seed % 3 else hand((Piece(SHAPES[seed % len(SHAPES)]),))
    chords = Chords(scene_with(avatar, obstacles(rng)))
    before, after = two_postures(avatar, rng, size)
    until, pair = chords.free_until(before, after)
    gaps = gaps_along(chords, before, after, np.linspace(0.0, until, SAMPLES))
    assert (gaps[:-1] > 0.0).all() or (until == 0.0 and gaps[0] <= 1e-7)
    if until < 1.0:
        # just behind the end of the proof a gap is as small as the curvature over the shortest interval
        beyond = gaps_along(chords, before, after, np.linspace(until, min(1.0, until + 2.0**-DEPTH), 20))
        assert pair is not None and beyond.min() < 1e-5


@given(st.integers(0, 10**6), st.sampled_from((0.1, 1.0)))
def test_no_point_bends_more_than_its_bound(seed: int, size: float) -> None:
    """Second differences of every vertex along the way, in the world; and of one link's as another one sees them."""
    avatar, rng, step = sliding_avatar(), np.random.default_rng(seed), 1e-3
    chords = Chords(scene_with(avatar, ()))
    before, after = two_postures(avatar, rng, size)
    chords.free_until(before, after)
    geo, segment = chords.world.geometry, chords.parts
    for share in rng.uniform(step, 1.0 - step, 5):
        places = [placed(chords, between(before, after, float(share + k * step))) for k in (-1, 0, 1)]
        bends = np.linalg.norm(places[0] - 2.0 * places[1] + places[2], axis=1) / step**2
        for s in range(len(geo.body)):
            most = bends[geo.shapes.start[s] : geo.shapes.start[s + 1]].max()
            assert most <= segment.curvature[s] * (1.0 + 1e-3) + 1e-6


def placed(chords: Chords, sample: TrackerSample) -> np.ndarray:
    """Return vertices (nv, 3) of all pieces at a posture, by the plain kinematics of samples."""
    positions, turns = link_poses(chords.scene.avatars, sample)
    geo = chords.world.geometry
    owner = np.repeat(geo.body, np.diff(geo.shapes.start)) - len(chords.scene.bodies)
    return positions[owner] + np.einsum("nij,nj->ni", rotation.to_matrix(turns)[owner], geo.local)


@pytest.mark.parametrize("turn", [0.1, 2.0])
def test_the_bound_of_one_hinge_is_reached(turn: float) -> None:
    chords = Chords(scene_with(arm(), ()))
    chords.free_until(turned(arm(), -turn), turned(arm(), turn))
    assert chords.parts.curvature.max() == pytest.approx(1.0 * (2.0 * turn) ** 2)


@settings(max_examples=30)
@given(st.integers(0, 10**6))
def test_a_gap_that_is_asked_for_is_kept(seed: int) -> None:
    rng = np.random.default_rng(seed)
    avatar, least = sliding_avatar(), 3e-3
    chords = Chords(scene_with(avatar, obstacles(rng)))
    before, after = two_postures(avatar, rng, 0.1)
    until, _ = chords.free_until(before, after, least)
    assert until <= chords.free_until(before, after)[0]
    gaps = gaps_along(chords, before, after, np.linspace(0.0, until, 200))
    assert (gaps[:-1] >= least - 1e-12).all() or until == 0.0


def arm(reach: float = 1.0) -> Avatar:
    """Return a rod that turns about a root at rest, its end a metre away."""
    rod = (Piece(Capsule(0.01, reach), (0.5 * reach, 0.0, 0.0), (float(np.sqrt(0.5)), 0.0, float(np.sqrt(0.5)), 0.0)),)
    ball = (Piece(Sphere(0.02)),)
    links = (
        Link("root", None, Free(), ball, solid(ball, 1.0)),
        Link("rod", "root", Hinges((Hinge(Y, -3.0, 3.0),)), rod, solid(rod, 1.0)),
    )
    return Avatar("arm", links)


def turned(avatar: Avatar, angle: float) -> TrackerSample:
    return replace(rest((avatar,)), angles=np.array([angle]))


@pytest.mark.parametrize("turn", [0.1, 0.5, 1.5])
def test_a_rod_that_bulges_into_a_plate_is_found(turn: float) -> None:
    """Both ends of the way are free by the same gap; only the arc between is not."""
    avatar = arm()
    reach = np.cos(turn) + 0.011
    assert reach < 1.01
    plate = fixed("plate", (Piece(Box((0.1, 1.0, 4.0))),), "wood", (float(reach) + 0.05, 0.0, 0.0))
    chords = Chords(scene_with(avatar, (plate,)))
    until, pair = chords.free_until(turned(avatar, -turn), turned(avatar, turn))
    assert pair == ("plate", "arm/rod") and 0.0 < until < 0.5
    # where the rod's end touches, by the law of cosines of a rod whose end is a ball
    angle = np.arccos((reach - 0.01) / 1.0)
    assert until == pytest.approx(0.5 * (1.0 - angle / turn), abs=2.0**-DEPTH)


@pytest.mark.parametrize("turn", [0.1, 0.5, 1.5])
def test_a_rod_that_passes_a_plate_by_a_hair_is_proved_free(turn: float) -> None:
    avatar = arm()
    plate = fixed("plate", (Piece(Box((0.1, 1.0, 4.0))),), "wood", (1.01 + 1e-6 + 0.05, 0.0, 0.0))
    assert Chords(scene_with(avatar, (plate,))).free_until(turned(avatar, -turn), turned(avatar, turn))[0] == 1.0


def test_links_that_turn_with_their_ancestor_are_proved_at_once() -> None:
    """Two fingers a micrometre apart on a hand that turns by three radians: in its frame nothing moves."""
    palm, finger = (Piece(Sphere(0.02)),), (Piece(Box((0.02, 0.02, 0.2)), (0.0, 0.0, 0.2)),)
    links = [Link("palm", None, Free(), palm, solid(palm, 1.0))]
    for name, x in (("one", -0.0100005), ("other", 0.0100005)):
        links.append(Link(name, "palm", Hinges((Hinge(X, -1.0, 1.0),)), finger, solid(finger, 0.1), anchor=(x, 0.0, 0.0)))
    avatar = Avatar("hand", tuple(links))
    chords = Chords(Scene("hand", (), (avatar,), start=rest((avatar,))))
    before = rest((avatar,))
    after = replace(before, rotations=np.tile(rotation.from_rotation_vector((0.0, 3.0, 0.0)), (3, 1)))
    assert chords.free_until(before, after)[0] == 1.0


def test_postures_outside_limits_come_to_the_nearest_within() -> None:
    avatar = sliding_avatar()
    chords = Chords(scene_with(avatar, ()))
    inside, beyond = chords.clipped(rest((avatar,)))
    wild = replace(rest((avatar,)), angles=np.array([2.5, -1.25, 0.0, 1.2, 0.0]))
    clipped, excess = chords.clipped(wild)
    assert excess == pytest.approx((0.5, 0.3)) and clipped.angles.tolist() == [2.0, -1.0, 0.0, 0.9, 0.0]
    assert max(chords.clipped(clipped)[1]) <= 1e-12


def test_a_share_of_a_way_is_where_a_motion_has_it() -> None:
    avatar, rng = sliding_avatar(), np.random.default_rng(3)
    before, after = two_postures(avatar, rng, 1.0)
    after = replace(after, rotations=-after.rotations)
    motion = Motion(
        np.array([0.0, 1.0]), np.array([before.positions, after.positions]), np.array([before.rotations, after.rotations]),
        np.array([before.angles, after.angles]),
    )
    for share in (0.0, 0.3, 1.0):
        one, other = between(before, after, share), motion.between(0, share)
        assert np.allclose(rotation.to_matrix(one.rotations), rotation.to_matrix(other.rotations), atol=1e-12)
        assert np.allclose(one.positions, other.positions, atol=1e-12) and np.allclose(one.angles, other.angles, atol=1e-12)


def test_a_ball_turns_the_short_way() -> None:
    """An arm on a ball sweeps through a post in its way."""
    rod = (Piece(Capsule(0.02, 0.4), (0.0, 0.0, 0.3)),)
    ball = (Piece(Sphere(0.02)),)
    links = Link("root", None, Free(), ball, solid(ball, 1.0)), Link("arm", "root", Ball(), rod, solid(rod, 1.0))
    avatar = Avatar("arm", links)
    post = fixed("post", (Piece(Sphere(0.02)),), "wood", (0.3, 0.0, 0.0))
    chords = Chords(scene_with(avatar, (post,)))
    before, after = rest((avatar,)), rest((avatar,))
    after = replace(after, rotations=np.array([rotation.IDENTITY, rotation.from_rotation_vector((0.0, 3.0, 0.0))]))
    until, pair = chords.free_until(before, after)
    assert pair == ("post", "arm/arm") and until == pytest.approx((0.5 * np.pi - np.arcsin(0.04 / 0.3)) / 3.0, abs=1e-2)


def test_the_nearest_common_ancestor_of_each_pair_of_links() -> None:
    avatar = sliding_avatar()
    found = common_ancestors(Chords(scene_with(avatar, ())).world.skeleton)
    assert found.tolist() == [
        [0, 0, 0, 0, 0, 0, 0], [0, 1, 1, 1, 0, 0, 0], [0, 1, 2, 2, 0, 0, 0], [0, 1, 2, 3, 0, 0, 0], [0, 0, 0, 0, 4, 0, 0],
        [0, 0, 0, 0, 0, 5, 5], [0, 0, 0, 0, 0, 5, 6],
    ]
