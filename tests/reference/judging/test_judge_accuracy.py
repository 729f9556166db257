"""The judge against exact answers: 2,000 random pairs of each kind, and the kinds that go wrong."""

import numpy as np
import pytest

from avatarsim.scene.body import Mass, fixed, simulated
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Ellipsoid, Piece, Shape, ellipsoid_hull
from avatarsim.spatial import rotation
from reference.judge_trust import Draw, draws
from reference.judging.geometry import Outline, rounded_points
from reference.judging.judge import Judge
from reference.judging.known_pairs import KINDS, REACH, Gallery, Placed, box, capsule, exact
from reference.judging.minkowski import signed_distance
from reference.judging.proof import by_directions

PROMISE = 1e-8


def judge_of(*pairs: tuple[Shape, Shape]) -> Judge:
    """Return the judge of a scene of pairs: body k is fixed and body n + k is simulated."""
    bodies = [fixed(f"a{k}", (Piece(a),), "wood") for k, (a, _) in enumerate(pairs)]
    bodies += [simulated(f"b{k}", (Piece(b),), "wood", Mass(1.0)) for k, (_, b) in enumerate(pairs)]
    return Judge(Scene("pairs", tuple(bodies)))


@pytest.mark.parametrize("kind", KINDS)
def test_judge_agrees_with_exact_answers(kind):
    """500 of every regime: a hair apart, shallow, at the bound and deep."""
    found = list(draws(kind, 500, np.random.default_rng(sum(map(ord, kind)))))
    assert sum(len(part.placed.exact) for part in found) == 2000
    for part in found:
        assert part.judged() == pytest.approx(part.placed.exact, abs=PROMISE)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "ellipsoids and floors"])
def test_judge_agrees_with_exact_answers_farther_apart(kind):
    """A floor is left out, through which an ellipsoid would be pushed."""
    rng = np.random.default_rng(7)
    gallery = Gallery(kind, 100, rng)
    placed = gallery.placed("apart", rng)
    at, turns = placed.positions.copy(), rotation.to_matrix(placed.orientations)
    at[:100] += rng.normal(size=(100, 3)) * rng.choice([0.03, 0.1, 0.3], (100, 1))
    wanted = [exact(a, turns[k], b, turns[100 + k], at[k] - at[100 + k]) for k, (a, b) in enumerate(gallery.shapes)]
    assert (np.array(wanted) > 1e-3).sum() > 20
    assert Draw(gallery, Placed(at, placed.orientations, np.array(wanted))).judged() == pytest.approx(wanted, abs=PROMISE)


@pytest.mark.parametrize("tilt", [0.0, 1e-14, 1e-10, 1e-8, 1e-7, 1e-6, 1e-5, 1e-3])
def test_nearly_aligned_boxes_are_judged_right(tilt):
    rng = np.random.default_rng(11)
    n = 200
    sizes = rng.integers(1, 6, (2 * n, 3)) * 0.05
    judge = judge_of(*((Box(tuple(a)), Box(tuple(b))) for a, b in zip(sizes[:n], sizes[n:], strict=True)))
    turns = np.tile(rotation.IDENTITY, (2 * n, 1))
    turns[n:] = rotation.from_rotation_vector(tilt * rng.normal(size=(n, 3)))
    matrices = rotation.to_matrix(turns)
    at_b = np.arange(n)[:, None] * np.array([4.0, 0.0, 0.0])
    at_a = at_b + rng.integers(-4, 5, (n, 3)) * 0.05
    corners = [rounded_points(Box(tuple(size)))[0] @ turn.T for size, turn in zip(sizes, matrices, strict=True)]
    wanted = np.array([signed_distance(corners[k] + at_a[k] - at_b[k], 0.0, corners[n + k], 0.0) for k in range(n)])
    first, second, found = judge.distances(np.concatenate([at_a, at_b]), turns)
    overlapping = found < -PROMISE
    assert set(np.minimum(first, second)[overlapping]) >= set(np.flatnonzero(wanted < -2.0 * PROMISE))
    assert found[overlapping] == pytest.approx(wanted[np.minimum(first, second)[overlapping]], abs=PROMISE)


def test_what_the_fast_answer_gets_wrong_goes_to_brute_force():
    # 400 aligned pairs tilted by 1e-10 hold several touching ones, whose normal proves nothing
    rng = np.random.default_rng(5)
    stack = Scene("touching", (
        fixed("table", (Piece(Box((1.0, 1.0, 0.1))),), "wood"),
        *(simulated(f"cube{k}", (Piece(Box((0.1, 0.1, 0.1))),), "wood", Mass(1.0)) for k in range(9)),
    ))
    judge, decided = Judge(stack), 0
    for _ in range(200):
        at = np.zeros((10, 3))
        at[1:] = [(-0.4 + 0.1 * k, rng.uniform(-0.2, 0.2), 0.1) for k in range(9)]
        turns = np.tile(rotation.IDENTITY, (10, 1))
        turns[1:] = rotation.from_rotation_vector(1e-10 * rng.normal(size=(9, 3)))
        verdict = judge.overlaps(at, turns)
        assert verdict.deepest <= PROMISE
        decided += verdict.decided
    assert decided > 0


def test_ellipsoids_agree_with_brute_force_over_directions():
    rng = np.random.default_rng(13)
    for k in range(60):
        first, second = (Ellipsoid(tuple(rng.uniform(0.03, 0.2, 3))) for _ in range(2))
        shapes = [first, (second, box(rng), capsule(rng))[k % 3]]
        judge = judge_of((shapes[0], shapes[1]))
        turns = rotation.normalised(rng.normal(size=(2, 4)))
        at = np.array([rng.normal(size=3) * 0.1, np.zeros(3)])
        _, _, found = judge.distances(at, turns, REACH)
        matrices = rotation.to_matrix(turns)
        brute = by_directions(Outline(shapes[0]), matrices[0], Outline(shapes[1]), matrices[1], at[0])
        assert found[0] == pytest.approx(brute, abs=PROMISE)


def test_concentric_hulls_are_judged_right():
    for radii in ((0.1, 0.15, 0.2), (0.17, 0.17, 0.18), (0.02, 0.2, 0.2)):
        shape = ellipsoid_hull(radii)
        verdict = judge_of((shape, shape)).overlaps(np.zeros((2, 3)), np.tile(rotation.IDENTITY, (2, 1)))
        exact = -signed_distance(shape.vertices, 0.0, shape.vertices, 0.0)
        assert verdict.deepest == pytest.approx(exact, abs=PROMISE)
        # the fast way must find it: brute force behind it would hide that it stopped too early
        assert verdict.decided == 0
