"""The certificate of a step: what passed through something is refused, what slides is not, and a nan never passes."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.collide.scratch import make_scratch
from avatarsim.collide.signed_distance import signed_distance
from avatarsim.posture.certificate import accepted_gap
from avatarsim.posture.certify import certify
from avatarsim.posture.kinematics import forward
from avatarsim.scene.body import fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import rest
from avatarsim.world.geometry import place
from avatarsim.world.pair_filter import may_meet
from tests.posture.little_worlds import SETTINGS, Little, at, hand, hand_scene, little, mixed_avatar, panel

SCRATCH = make_scratch()
HANDS = {
    "ball": (Piece(Sphere(0.05)),), "box": (Piece(Box((0.1, 0.08, 0.06))),), "capsule": (Piece(Capsule(0.03, 0.1)),),
    "hull": (Piece(ellipsoid_hull((0.05, 0.04, 0.08))),),
}


def failures(found: Little, step: object) -> int:
    """Failed pairs of the step (nd) from the world's posture."""
    geo, skel, posture, poses = found.parts
    found.memory.rows.x[:] = np.broadcast_to(step, found.memory.rows.x.shape)
    forward(geo, skel, posture, found.memory.rows.x, found.memory.trial, found.memory.trial_axes)
    return int(certify(geo, skel, poses, SETTINGS, found.memory))


def move(x: float = 0.0, y: float = 0.0, z: float = 0.0, *turn: float) -> list[float]:
    """A step of one free link."""
    return [x, y, z, *(turn or (0.0, 0.0, 0.0))]


@pytest.mark.parametrize("name", HANDS)
def test_a_jump_through_a_panel_of_two_millimetres_is_refused(name: str) -> None:
    """Both ends are free and the boxes around them are far from the panel: only the way between is not."""
    for distance in (0.06, 0.2, 1.0):
        found = little(hand_scene((-distance, 0.0, 0.0), panel(), shape=HANDS[name]))
        assert failures(found, move(2.0 * distance)) == 1
        assert failures(found, move(2.0 * distance, 0.3, 0.2, 0.3, 0.2, 0.1)) == 1


@pytest.mark.parametrize("name", HANDS)
def test_passing_beside_the_panel_is_not_refused(name: str) -> None:
    found = little(hand_scene((-0.2, 1.2, 0.0), panel(), shape=HANDS[name]))
    assert failures(found, move(0.4)) == 0


@pytest.mark.parametrize("name", HANDS)
@pytest.mark.parametrize("turn", [(), (0.3, 0.0, 0.0)])
def test_sliding_along_a_wall_is_accepted_however_far(name: str, turn: tuple[float, ...]) -> None:
    found = little(hand_scene((-0.06, -0.9, 0.0), panel(), shape=HANDS[name]))
    assert failures(found, move(0.0, 1.8, 0.5, *turn)) == 0


def test_the_gap_at_the_end_decides() -> None:
    face = -0.001 - 0.05
    found = little(hand_scene((face - 0.01, 0.0, 0.0), panel()))
    assert failures(found, move(0.01 - 1.01 * SETTINGS.least_gap)) == 0
    assert failures(found, move(0.01 - 0.99 * SETTINGS.least_gap)) == 1
    assert failures(found, move(0.01)) == 1 and failures(found, move(0.03)) == 1


def test_standing_still_is_always_accepted_however_narrow() -> None:
    for gap in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        found = little(hand_scene((-0.001 - 0.05 - gap, 0.0, 0.0), panel()))
        assert failures(found, 0.0) == 0


@pytest.mark.parametrize("gap", [1e-5, 1e-2, 5.0])
@pytest.mark.parametrize("degree", [0, 4, None])
def test_a_nan_fails_near_and_far(degree: int | None, gap: float) -> None:
    """A pose that is no pose is never proved apart from anything, not even where no box is near."""
    found = little(hand_scene((-0.051 - gap, 0.0, 0.0), panel()))
    step = np.zeros(6)
    step[slice(None) if degree is None else degree] = np.nan
    assert failures(found, step) > 0


def test_a_nan_in_a_joint_fails() -> None:
    scene = Scene("s", (panel(x=-5.0),), (mixed_avatar(),))
    for j in range(6, 12):
        found = little(scene)
        step = np.zeros(12)
        step[j] = np.nan
        assert failures(found, step) > 0


def test_links_are_certified_against_each_other() -> None:
    """Two hands cannot pass each other, though nothing fixed is near."""
    pair = (hand(), hand(name="other"))
    start = at(rest(pair), (-0.2, 0.0, 0.0))
    found = little(Scene("s", (panel(x=-5.0),), pair, start=start))
    step = np.zeros(12)
    step[0] = 0.4
    assert failures(found, step) == 1
    step[6] = 0.4
    assert failures(found, step) == 0
    # both move: they swap places
    step[6] = -0.4
    assert failures(found, step) == 1


def interpolated_gap(found: Little, before: np.ndarray, after: np.ndarray, t: float) -> float:
    """Least signed distance over wanted pairs with every vertex on its straight way from before to after."""
    geo = found.world.geometry
    vertices = np.ascontiguousarray((1.0 - t) * before + t * after)
    gaps = [
        signed_distance(vertices, geo.shapes, a, b, (0.0, 0.0, 0.0), SCRATCH)[1]
        for (a, i), (b, k) in product(enumerate(geo.body), repeat=2) if i < k and may_meet(geo.wanted, i, k)
    ]
    return min(gaps)


@given(st.integers(0, 100_000), st.sampled_from(sorted(HANDS)))
def test_a_certified_step_never_overlaps_on_its_way(seed: int, name: str) -> None:
    """Random steps among a panel and a post; what is certified is free at a dozen instants between."""
    rng = np.random.default_rng(seed)
    post = fixed("post", (Piece(Capsule(0.02, 1.0)),), "wood", (0.15, 0.05, 0.0))
    found = little(hand_scene((0.1, -0.12, 0.0), panel(), post, shape=HANDS[name]))
    step = np.concatenate([rng.normal(size=3) * [0.1, 0.2, 0.05], rng.normal(size=3) * 0.3])
    before = found.world.poses.vertices.copy()
    if failures(found, step) == 0:
        after = found.memory.trial.vertices.copy()
        assert min(interpolated_gap(found, before, after, t) for t in np.linspace(0.0, 1.0, 13)) > 0.0
    else:
        assert min(interpolated_gap(found, before, found.memory.trial.vertices, t) for t in np.linspace(0.0, 1.0, 60)) < 0.02


def test_a_moved_body_is_seen_where_it_is() -> None:
    """The trial's copy of a fixed body is that of the world, or nothing would be in the way."""
    found = little(hand_scene((-0.2, 0.0, 0.0), panel(x=3.0)))
    assert failures(found, move(0.4)) == 0
    for poses in (found.world.poses, found.memory.trial):
        poses.position[0] = (0.0, 0.0, 0.0)
        place(found.world.geometry, poses, 0)
    found.memory.swept[0], found.memory.swept_hulls[0] = found.world.poses.boxes[0], found.world.poses.hulls[0]
    found.memory.reach[:] = 0.0
    assert failures(found, move(0.4)) == 1


@given(st.floats(1e-12, 1.0))
def test_the_accepted_gap_lets_a_pair_stand_still_and_a_wedged_one_come_no_nearer(gap: float) -> None:
    least = accepted_gap(SETTINGS, gap)
    assert least <= gap and least <= SETTINGS.least_gap
    if gap >= SETTINGS.wedged_gap:
        assert least >= SETTINGS.wedged_gap - 1e-9
    else:
        assert least >= gap - 1e-9


def test_a_wedged_pair_does_not_creep_together_over_many_steps() -> None:
    gap = 1e-4
    for _ in range(1000):
        gap = accepted_gap(SETTINGS, gap)
    assert gap >= 0.5 * SETTINGS.wedged_gap


@pytest.mark.parametrize("gap", [np.nan, -np.inf, -1e-6, 0.0])
def test_a_pair_that_is_not_apart_promises_nothing(gap: float) -> None:
    assert not accepted_gap(SETTINGS, gap) > SETTINGS.least_gap
