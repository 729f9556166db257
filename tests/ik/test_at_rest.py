"""Pairs that overlap at home: certified no deeper than they may be, in the steps of the engine and between recorded postures."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import avatarsim as av
from avatarsim.cleaning.chords import Chords
from avatarsim.model.geometry import rest_depth, rest_depths
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Shape, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from reference.judging.judge import Judge
from tests.worlds.little_worlds import Y, Z

HOME = 0.005
"""[m] overlap of the two outer links at home."""

SHAPES: tuple[Shape, ...] = (Box((0.1, 0.08, 0.06)), ellipsoid_hull((0.05, 0.04, 0.03)), Capsule(0.03, 0.04))


def jointed(shape: Shape, depth: float = HOME, allowed: float | None = None) -> Avatar:
    """Return two equal links that overlap by about `depth` [m] along x, each on a hinge of a post between them."""
    long = 0.1
    apart = 0.5 * (long - depth)
    mass = solid((Piece(Box((0.05, 0.05, 0.05))),), 1.0)
    hinge = Hinges((Hinge(Z, -1.5, 1.5), Hinge(Y, -1.5, 1.5)))
    links = (
        Link("post", None, Hinges((Hinge(Z, -1.5, 1.5),)), (), mass, anchor=(0.0, 0.0, 0.0)),
        Link("left", "post", hinge, (Piece(shape, (0.0, 0.1, 0.0)),), mass, anchor=(-apart, -0.1, 0.0)),
        Link("right", "post", hinge, (Piece(shape, (0.0, 0.1, 0.0)),), mass, anchor=(apart, -0.1, 0.0)),
    )
    at_rest = () if allowed is None else (("left", "right", allowed),)
    return Avatar("pair", links, at_rest=at_rest, size_range=(0.01, 10.0))


def depth_by_directions(avatar: Avatar, samples: list[TrackerSample]) -> float:
    """Return the deepest overlap [m] of the outer links by another way: brute force over directions, in the judge's library."""
    judge = Judge(Scene("judged", (), (replace(avatar, at_rest=()),)))
    places = [link_poses((avatar,), sample) for sample in samples]
    return judge.deepest(np.array([at for at, _ in places]), np.array([turned for _, turned in places]))


def bent(angles: np.ndarray) -> TrackerSample:
    """Return a posture with these angles (5)."""
    still = rest((jointed(SHAPES[0]),))
    return replace(still, angles=np.asarray(angles, dtype=np.float64))


def test_the_table_of_depths_is_found_in_any_order() -> None:
    pairs = [(3, 1, 0.1), (0, 7, 0.2), (5, 6, 0.3), (2, 4, 0.4)]
    table = rest_depths(8, pairs)
    for a in range(8):
        for b in range(8):
            wanted = [depth for i, k, depth in pairs if {i, k} == {a, b}]
            assert rest_depth(table, a, b) == (wanted[0] if wanted else 0.0)
    assert rest_depth(rest_depths(8), 3, 1) == 0.0


@given(st.integers(0, 10**6), st.sampled_from(range(len(SHAPES))))
def test_on_a_proved_way_no_pair_is_deeper_than_it_may_be(seed: int, kind: int) -> None:
    rng = np.random.default_rng(seed)
    home = depth_by_directions(jointed(SHAPES[kind]), [bent(np.zeros(5))])
    avatar = jointed(SHAPES[kind], allowed=home + 2e-4)
    chords = Chords(Scene("pair", (), (avatar,)))
    before, after = (bent(rng.normal(size=5) * 0.15) for _ in range(2))
    until, pair = chords.free_until(before, after)
    motion = Motion(np.array([0.0, 1.0]), *(np.array([getattr(one, name) for one in (before, after)])
                                             for name in ("positions", "rotations", "angles")))
    some = [motion.between(0, float(share)) for share in np.linspace(0.0, until, 40)]
    if until > 0.0:
        assert depth_by_directions(avatar, some) <= home + 2e-4 + 1e-6
    if until < 1.0:
        assert pair == ("pair/left", "pair/right")


@pytest.mark.parametrize("kind", range(len(SHAPES)))
def test_a_joint_stops_links_at_the_depth_of_home(kind: int) -> None:
    home = depth_by_directions(jointed(SHAPES[kind]), [bent(np.zeros(5))])
    avatar = jointed(SHAPES[kind], allowed=home + 2e-4)
    into = np.array([0.0, -0.3, 0.0, 0.3, 0.0])
    assert depth_by_directions(avatar, [bent(into)]) > home + 0.02
    scene, shown = Scene("pair", (), (avatar,)), []
    with av.AvatarsimEngine() as engine:
        engine.load(scene, av.Settings(), 1 / 60)
        for frame in range(90):
            share = np.sin(np.pi * frame / 60)
            record = engine.advance(replace(bent(share * into), time=frame / 60), 1 / 60)
            shown.append(record.shown)
    places = np.array([one.positions for one in shown]), np.array([one.orientations for one in shown])
    assert Judge(replace(scene, avatars=(replace(avatar, at_rest=()),))).deepest(*places) <= home + 2e-4 + 1e-6
    assert Judge(scene).deepest(*places) <= 1e-6
    # on the way apart nothing holds them
    turned = 2.0 * np.arcsin(np.abs(places[1][:, 1:, 3]))
    assert turned[:60].max() < 0.2 < turned[60:].max()
