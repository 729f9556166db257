"""Separation by PD_g: overlaps are found, both bodies move by their shares, and eq. 1 is applied over all pieces."""

import numpy as np
import pytest

from avatarsim.collision.scratch import PIECES_CAP
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.status import CONVERGED, NOT_FINITE, OUT_OF_ITERATIONS, OUT_OF_ROOM
from avatarsim.model.dynamics import DRIVEN, FIXED, SIMULATED
from avatarsim.model.geometry import place
from avatarsim.paper.push_apart import (
    NOT_CHECKED,
    QUERIED,
    STAY,
    answer_for,
    find_overlaps,
    global_depth,
    lengthened,
    make_overlaps,
    push_apart,
    shares,
)
from avatarsim.pose_queries import overlapping_pairs
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.shape import Box, Piece, Sphere
from tests.collision.solids import SCRATCH, as_arrays, ball, box, hull_of_ellipsoid
from tests.worlds.arms import ball_hand, world_of

RADIUS = 0.2


def put(world, body, position):
    world.poses.position[body] = position
    place(world.geometry, world.poses, body)


@pytest.mark.parametrize(("share_a", "share_b"), [(0.5, 0.5), (1.0, 0.0), (0.0, 1.0), (0.25, 0.75)])
def test_shares_move_both_by_their_part_and_leave_the_stand_off(share_a, share_b):
    world, stand_off = world_of((ball_hand(RADIUS, "a"), ball_hand(RADIUS, "b"))), 1e-4
    put(world, 1, [0.3, 0.0, 0.0])
    status, of_a, of_b = push_apart(world.geometry, world.poses, 0, 1, share_a, share_b, stand_off, SCRATCH)
    assert status == CONVERGED
    assert of_a == pytest.approx((-share_a * (0.1 + stand_off), 0.0, 0.0), abs=1e-12)
    assert of_b == pytest.approx((share_b * (0.1 + stand_off), 0.0, 0.0), abs=1e-12)
    put(world, 0, world.poses.position[0] + of_a)
    put(world, 1, world.poses.position[1] + of_b)
    gap = signed_distance(world.poses.vertices, world.geometry.shapes, 0, 1, STAY, SCRATCH)[1]
    assert gap == pytest.approx(stand_off, abs=1e-12)


def test_the_stand_off_lengthens_a_push_and_leaves_no_push_alone():
    assert lengthened((0.0, 3.0, 4.0), 1.0) == pytest.approx((0.0, 3.6, 4.8))
    assert lengthened((0.0, 0.0, 0.0), 1.0) == (0.0, 0.0, 0.0)


CUBE, BALL = Piece(Box((0.4, 0.4, 0.4))), Piece(Sphere(0.2))


def crowd():
    bodies = (fixed("cube", (CUBE,), "wood"), simulated("ball", (BALL,), "wood", solid((BALL,), 1.0)))
    return world_of(tuple(ball_hand(0.15, f"hand{k}") for k in range(5)), bodies)


def test_it_finds_what_trying_every_pair_finds():
    world, rng, seen = crowd(), np.random.default_rng(4), 0
    found = make_overlaps(world.geometry, world.skeleton.first)
    names = world.scene.names
    for _ in range(200):
        for body in range(7):
            put(world, body, rng.uniform(-0.5, 0.5, 3))
        count = find_overlaps(world.geometry, world.poses, found)
        listed = {frozenset(names[body] for body in pair) for pair in found.found[:count]}
        everything = {frozenset((a, b)) for a, b, _ in overlapping_pairs(world)}
        # cube and ball are outside the driven loop
        assert listed == everything - {frozenset(("cube", "ball"))}
        assert {names[body] for body in np.flatnonzero(found.hit)} == {name for pair in listed for name in pair}
        seen += len(listed)
    assert seen > 300


def test_a_body_that_gave_way_is_answered_for_until_it_is_let_go():
    world = crowd()
    found = make_overlaps(world.geometry, world.skeleton.first)
    for body in range(7):
        put(world, body, [3.0 * body, 0.0, 0.0])
    put(world, 1, [0.1, 0.0, 0.0])
    assert find_overlaps(world.geometry, world.poses, found) == 0
    answer_for(1, True, found)
    assert find_overlaps(world.geometry, world.poses, found) == 1
    answer_for(1, False, found)
    assert find_overlaps(world.geometry, world.poses, found) == 0


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_pose_that_is_no_number_is_never_free(bad):
    world = crowd()
    found = make_overlaps(world.geometry, world.skeleton.first)
    for body in range(7):
        put(world, body, [3.0 * body, 0.0, 0.0])
    # without compilation numpy warns of cases that the kernels test for
    with np.errstate(invalid="ignore"):
        put(world, 4, [bad, 0.0, 0.0])
        assert find_overlaps(world.geometry, world.poses, found) == NOT_CHECKED


@pytest.mark.parametrize(("gap", "count"), [(-1e-12, 1), (1e-12, 0)])
def test_it_tells_a_billionth_of_a_millimetre_either_way(gap, count):
    world = crowd()
    found = make_overlaps(world.geometry, world.skeleton.first)
    for body in range(7):
        put(world, body, [3.0 * body, 0.0, 0.0])
    # aslant, so that their boxes meet
    put(world, 3, np.array([6.0, 0.0, 0.0]) + (0.3 + gap) * np.array([0.6, 0.8, 0.0]))
    found.tally[:] = 0
    assert find_overlaps(world.geometry, world.poses, found) == count
    assert found.tally[QUERIED] >= 1


pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def run(a_pieces, b_pieces):
    """Return the status, PD_g and number of pairs of two bodies, each of some pieces."""
    vertices, shapes = as_arrays(*a_pieces, *b_pieces)
    starts = np.array([0, len(a_pieces), len(a_pieces) + len(b_pieces)])
    status, pushed, count = global_depth(vertices, shapes, starts, 0, 1, SCRATCH)
    return status, np.array(pushed), count


def test_the_status_of_a_piece_is_not_lost():
    apart = ball(0.1).moved(shift=(9.0, 9.0, 9.0))
    # Two nearly round hulls about one centre: thousands of separating directions with nearly equal depths.
    dotted, larger = hull_of_ellipsoid((0.3, 0.301, 0.302), 40, 19), hull_of_ellipsoid((0.5, 0.499, 0.498), 37, 17)
    assert run([apart, larger], [dotted, apart])[0] == OUT_OF_ITERATIONS
    broken = ball(0.1).moved(shift=(np.nan, 0.0, 0.0))
    assert run([ball(0.5), broken], [ball(0.5).moved(shift=(0.1, 0.0, 0.0))])[0] == NOT_FINITE


def test_more_pairs_than_fit_is_a_status():
    many = [ball(0.5).moved(shift=(0.001 * k, 0.0, 0.0)) for k in range(PIECES_CAP // 8 + 1)]
    eight = [ball(0.5).moved(shift=(0.0, 0.1 + 0.001 * k, 0.0)) for k in range(8)]
    assert run(many[:-1], eight)[0] == CONVERGED
    assert run(many, eight)[0] == OUT_OF_ROOM


ROLES = (FIXED, SIMULATED, DRIVEN)


@pytest.mark.parametrize(
    ("a", "b", "must", "expected"),
    [
        (FIXED, DRIVEN, False, (0.0, 1.0)),
        (SIMULATED, FIXED, False, (1.0, 0.0)),
        (DRIVEN, DRIVEN, False, (0.5, 0.5)),
        (SIMULATED, SIMULATED, False, (0.5, 0.5)),
        (SIMULATED, DRIVEN, False, (0.0, 1.0)),
        (SIMULATED, DRIVEN, True, (1.0, 0.0)),
        (FIXED, FIXED, True, (0.0, 0.0)),
    ],
)
def test_the_rule(a, b, must, expected):
    assert shares(a, b, must) == expected


@pytest.mark.parametrize("must", [False, True])
def test_it_does_not_matter_which_of_the_two_is_a(must):
    for a in ROLES:
        for b in ROLES:
            assert shares(a, b, must) == shares(b, a, must)[::-1]
            assert sum(shares(a, b, must)) == (0.0 if a == b == FIXED else 1.0)


DEPTH = 0.05
BODIES = {"cube": box(0.2, 0.2, 0.2), "ball": ball(0.2), "hull": hull_of_ellipsoid((0.3, 0.2, 0.2), 8, 3)}


def wall(cuts):
    """Return the pieces of a wall 1 m thick with its surface at z = 0, cut at right angles to x."""
    return [
        box(0.5 * (high - low), 1.0, 0.5).moved(shift=(0.5 * (low + high), 0.0, -0.5))
        for low, high in zip(cuts, cuts[1:], strict=False)
    ]


def sunk(name, x):
    """Return a body at depth DEPTH in the wall."""
    body = BODIES[name]
    return body.moved(shift=(x, 0.0, -body.rows[:, 2].min() + body.radius - DEPTH))


def cleared(body, pieces, most):
    """Return the passes until less than a micrometre of depth is left, and the distance that the body moved."""
    way = np.zeros(3)
    for passes in range(most + 1):
        status, pushed, _ = run([body.moved(shift=way)], pieces)
        assert status == CONVERGED
        if np.linalg.norm(pushed) < 1e-6:
            return passes, way
        way += pushed
    raise AssertionError(f"still {np.linalg.norm(pushed)} m after {most} passes")


EVEN = [list(np.linspace(-1.0, 1.0, count + 1)) for count in (1, 2, 3, 4, 8, 13, 16, 32, 64)]
SLIVERS = [[-1.0, at - 0.5 * width, at + 0.5 * width, 1.0] for width in (1e-2, 1e-4, 1e-6) for at in (0.0, 0.2)]


@pytest.mark.parametrize("cuts", [*EVEN[:7], *SLIVERS[::2]])
@pytest.mark.parametrize("x", [0.0, 0.0137])
def test_a_cut_or_a_sliver_under_the_flat_face_changes_nothing(cuts, x):
    status, pushed, _ = run([sunk("cube", x)], wall(cuts))
    assert status == CONVERGED
    np.testing.assert_allclose(pushed, (0.0, 0.0, DEPTH), atol=1e-12)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("x", [0.0, 0.0137])
@pytest.mark.parametrize(("cuts", "least", "drift", "passes", "drift_in_all"), [
    *((cuts, 0.66, 0.12, 6, 0.12) for cuts in EVEN), *((cuts, 0.64, 0.16, 16, 0.3) for cuts in SLIVERS),
])
def test_no_cut_goes_too_far_and_few_passes_reach_the_end(name, x, cuts, least, drift, passes, drift_in_all):
    status, pushed, _ = run([sunk(name, x)], wall(cuts))
    assert status == CONVERGED
    assert least * DEPTH < pushed[2] < DEPTH + 1e-12
    assert abs(pushed[0]) < drift * DEPTH and abs(pushed[1]) < 1e-12
    taken, way = cleared(sunk(name, x), wall(cuts), passes)
    assert taken >= 1
    np.testing.assert_allclose(way[2], DEPTH, atol=2e-6)
    assert abs(way[0]) < drift_in_all * DEPTH
