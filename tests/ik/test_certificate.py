"""The certificate of a step: it refuses a motion through a body, not one that slides or turns along; a nan never passes."""

from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.ik import gaps
from avatarsim.ik.broad_phase import notice_bodies
from avatarsim.ik.certificate import accepted_gap
from avatarsim.ik.certify import certify
from avatarsim.ik.kinematics import try_step
from avatarsim.model.geometry import may_meet
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import rest
from avatarsim.settings import PostureSettings
from tests.ik.solvers import Solver, solver_of
from tests.worlds.little_worlds import Z, at, hand, hand_scene, mixed_avatar, panel

SETTINGS, SCRATCH, ANY = PostureSettings(), make_scratch(), np.zeros(0, dtype=np.int64)
LEAST, WEDGED = gaps.least_gap(SETTINGS.stand_off), gaps.wedged_gap(SETTINGS.stand_off)
HANDS = {
    "ball": (Piece(Sphere(0.05)),), "box": (Piece(Box((0.1, 0.08, 0.06))),), "capsule": (Piece(Capsule(0.03, 0.1)),),
    "hull": (Piece(ellipsoid_hull((0.05, 0.04, 0.08))),),
}


def failures(found: Solver, step: Any) -> int:
    """Return the number of failures of the step (nd) from the world's posture."""
    geo, skel, posture, poses = found.world.geometry, found.world.skeleton, found.world.posture, found.world.poses
    notice_bodies(geo, skel, poses, ANY, found.working)
    found.solve_for_all()
    found.state.pairs.step[0] += 1
    found.state.tracking.is_certified[:] = 0
    found.working.step[:] = step
    for avatar in range(found.count):
        try_step(found.rig, avatar, posture, found.working)
    return int(certify(found.rig, SETTINGS, posture, poses, 0, found.count, False, False, found.state, found.working))


def move(x: float = 0.0, y: float = 0.0, z: float = 0.0, *turn: float) -> list[float]:
    """Return a step of one free link."""
    return [x, y, z, *(turn or (0.0, 0.0, 0.0))]


@pytest.mark.parametrize("name", HANDS)
def test_a_jump_through_a_panel_of_two_millimetres_is_refused(name: str) -> None:
    """Both ends are free and the boxes around them are far from the panel: only the way between is not."""
    for distance in (0.06, 0.2, 1.0):
        found = solver_of(hand_scene((-distance, 0.0, 0.0), panel(), shape=HANDS[name]))
        assert failures(found, move(2.0 * distance)) == 1
        assert failures(found, move(2.0 * distance, 0.3, 0.2, 0.3, 0.2, 0.1)) == 1


@pytest.mark.parametrize("name", HANDS)
@pytest.mark.parametrize("turn", [(), (0.3, 0.0, 0.0)])
def test_passing_beside_a_panel_and_sliding_along_it_pass(name: str, turn: tuple[float, ...]) -> None:
    beside = solver_of(hand_scene((-0.2, 1.2, 0.0), panel(), shape=HANDS[name]))
    assert failures(beside, move(0.4)) == 0
    along = solver_of(hand_scene((-0.06, -0.9, 0.0), panel(), shape=HANDS[name]))
    assert failures(along, move(0.0, 1.8, 0.5, *turn)) == 0


def test_the_last_gap_decides_and_standing_still_passes() -> None:
    face = -0.001 - 0.05
    found = solver_of(hand_scene((face - 0.01, 0.0, 0.0), panel()))
    assert failures(found, move(0.01 - 1.01 * LEAST)) == 0
    assert failures(found, move(0.01 - 0.99 * LEAST)) == 1
    assert failures(found, move(0.01)) == 1 and failures(found, move(0.03)) == 1
    for gap in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        assert failures(solver_of(hand_scene((face - gap, 0.0, 0.0), panel())), 0.0) == 0


@pytest.mark.parametrize("gap", [1e-5, 1e-2, 5.0])
def test_a_nan_fails_near_and_far(gap: float) -> None:
    """A pose that is no pose is never proved apart from anything, not even where no box is near."""
    found = solver_of(hand_scene((-0.051 - gap, 0.0, 0.0), panel()))
    for degree in (0, 4, slice(None)):
        step = np.zeros(6)
        step[degree] = np.nan
        assert failures(found, step) > 0
    tree = solver_of(Scene("s", (panel(x=-5.0),), (mixed_avatar(),)))
    for j in range(6, 12):
        step = np.zeros(12)
        step[j] = np.nan
        assert failures(tree, step) > 0


def test_links_of_two_avatars_are_certified_against_each_other() -> None:
    pair = (hand(), hand(name="other"))
    found = solver_of(Scene("s", (panel(x=-5.0),), pair, start=at(rest(pair), (-0.2, 0.0, 0.0))))
    step = np.zeros(12)
    step[0] = 0.4
    assert failures(found, step) == 1
    step[6] = 0.4
    assert failures(found, step) == 0
    step[6] = -0.4
    assert failures(found, step) == 1, "they swap places"


def moon() -> Solver:
    """Return a ball, and another that an arm carries round it at a distance of 1 cm without turning it."""
    ball, tip = (Piece(Sphere(0.05)),), (Piece(Sphere(0.005), (0.0, 0.0, 0.3)),)
    hinge = Hinges((Hinge(Z, -3.0, 3.0),))
    links = (
        Link("root", None, Free(), ball, solid(ball, 1.0)),
        Link("arm", "root", hinge, tip, solid(tip, 1.0)),
        Link("moon", "arm", hinge, ball, solid(ball, 1.0), anchor=(0.11, 0.0, 0.0)),
    )
    return solver_of(Scene("s", (), (Avatar("moons", links),)))


@pytest.mark.parametrize("turn", [0.0, 0.7, 1.5, 2.5, 3.1])
def test_an_avatar_that_turns_far_as_a_whole_is_not_refused(turn: float) -> None:
    """No nearest direction separates both ends, however it is carried along; the one halfway between does, carried along."""
    found, axis = moon(), np.array([0.6, -0.8, 0.0])
    assert failures(found, np.concatenate([[0.3, -2.0, 0.1], turn * axis, [0.7, -0.7]])) == 0


def least_gap(found: Solver, vertices: np.ndarray) -> float:
    """Return the least signed distance over wanted pairs."""
    geo = found.world.geometry
    return min(
        signed_distance(vertices, geo.shapes, a, b, (0.0, 0.0, 0.0), SCRATCH)[1]
        for (a, i), (b, k) in product(enumerate(geo.body), repeat=2) if i < k and may_meet(geo.wanted, i, k)
    )


@given(st.integers(0, 100_000), st.sampled_from(sorted(HANDS)))
def test_a_certified_step_never_overlaps_on_its_way(seed: int, name: str) -> None:
    """Random steps among a panel and a post; a certified step is free at a dozen instants between."""
    rng = np.random.default_rng(seed)
    post = fixed("post", (Piece(Capsule(0.02, 1.0)),), "wood", (0.15, 0.05, 0.0))
    found = solver_of(hand_scene((0.1, -0.12, 0.0), panel(), post, shape=HANDS[name]))
    step = np.concatenate([rng.normal(size=3) * [0.1, 0.2, 0.05], rng.normal(size=3) * 0.3])
    before = found.world.poses.vertices.copy()
    failed = failures(found, step)
    after = found.working.trial.vertices.copy()
    ways = [np.ascontiguousarray((1.0 - t) * before + t * after) for t in np.linspace(0.0, 1.0, 13 if failed == 0 else 60)]
    least = min(least_gap(found, way) for way in ways)
    assert least > 0.0 if failed == 0 else least < 0.05


@given(st.floats(1e-12, 1.0))
def test_the_accepted_gap_lets_a_pair_stand_still(gap: float) -> None:
    least = accepted_gap(SETTINGS.stand_off, gap)
    assert least <= gap and least <= LEAST
    assert least >= min(gap, WEDGED) - 1e-9


@pytest.mark.parametrize("gap", [np.nan, -np.inf, -1e-6, 0.0])
def test_a_pair_that_is_not_apart_promises_nothing(gap: float) -> None:
    assert not accepted_gap(SETTINGS.stand_off, gap) > LEAST


@pytest.mark.parametrize("stand_off", [1e-5, 1e-3, 0.1])
def test_gaps_are_ordered_and_scale_with_the_stand_off(stand_off: float) -> None:
    assert 0.0 < gaps.wedged_gap(stand_off) < gaps.least_gap(stand_off) < stand_off
    for gap in (gaps.wedged_gap, gaps.least_gap):
        assert gap(2.0 * stand_off) == pytest.approx(2.0 * gap(stand_off))
