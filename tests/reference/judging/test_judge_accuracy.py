"""The judge against exact answers: 2,000 random pairs and more of each kind in each regime, and the kinds that go wrong."""

from functools import cache

import numpy as np
import pytest

from avatarsim.scene.body import Mass, fixed, simulated
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.spatial import rotation
from reference.judging.exact_depth import Polytope, box_signed_distance, polytope_signed_distance
from reference.judging.geometry import Outline, rounded_points
from reference.judging.judge import Judge
from reference.judging.known_pairs import box, capsule, hull, plate, sphere
from reference.judging.minkowski import separated_distance, signed_distance
from reference.judging.proof import by_directions
from reference.judging.segments import segment_distance

PROMISE = 1e-8
PAIRS, ROUNDS, SPACING, REACH = 100, 20, 20.0, 3.0
REGIMES = ("shallow", "deep", "apart")
KINDS = {"spheres": sphere, "boxes": box, "capsules": capsule, "ellipsoid hulls": hull, "thin plates": plate}


@cache
def gallery(kind):
    """PAIRS pairs of shapes, the points and radii of both, outlines if they are hulls, and the judge; the poses come later."""
    rng = np.random.default_rng(sum(map(ord, kind)))
    shapes = [(KINDS[kind](rng), KINDS[kind](rng)) for _ in range(PAIRS)]
    bodies = [fixed(f"a{k}", (Piece(a),), "wood") for k, (a, _) in enumerate(shapes)]
    bodies += [simulated(f"b{k}", (Piece(b),), "wood", Mass(1.0)) for k, (_, b) in enumerate(shapes)]
    points = [(rounded_points(a), rounded_points(b)) for a, b in shapes]
    outlines = [(Polytope(a.vertices), Polytope(b.vertices)) for a, b in shapes] if isinstance(shapes[0][0], ConvexHull) else []
    return shapes, points, outlines, Judge(Scene("gallery", tuple(bodies)))


def offset_of(regime, a, radius_a, b, radius_b, rng):
    """Where to put the centre of a relative to b; a and b are points (n, 3) in world axes."""
    toward = rng.normal(size=3)
    toward /= np.linalg.norm(toward)
    if regime == "deep":
        # both kinds of shape are symmetric, so that every part of a difference of points is inside the difference
        rounding = (radius_a + radius_b) * toward
        return rng.uniform(0.0, 0.9) * (b[rng.integers(len(b))] - a[rng.integers(len(a))] + rounding)
    touching = b[np.argmax(b @ toward)] - a[np.argmin(a @ toward)] + (radius_a + radius_b) * toward
    if regime == "shallow":
        return touching - 10.0 ** rng.uniform(-7.0, -2.0) * toward
    aside = rng.normal(size=3) * rng.choice([0.0, 0.1, 0.3])
    return touching + 10.0 ** rng.uniform(-7.0, 0.0) * toward + aside - (aside @ toward) * toward


def exact_signed(shapes, points, outlines, turns_a, turns_b, offsets):
    """Exact signed distances of PAIRS pairs by whatever closed form or complete enumeration their kind has."""
    first, second = [a for a, _ in shapes], [b for _, b in shapes]
    if isinstance(first[0], Sphere):
        return np.linalg.norm(offsets, axis=1) - [a.radius + b.radius for a, b in shapes]
    if isinstance(first[0], Capsule):
        axis_a = 0.5 * np.array([a.length for a in first])[:, None] * turns_a[:, :, 2]
        axis_b = 0.5 * np.array([b.length for b in second])[:, None] * turns_b[:, :, 2]
        cores = segment_distance(offsets - axis_a, offsets + axis_a, -axis_b, axis_b)
        return cores - [a.radius + b.radius for a, b in shapes]
    if isinstance(first[0], Box):
        halves_a, halves_b = 0.5 * np.array([a.size for a in first]), 0.5 * np.array([b.size for b in second])
        signed = box_signed_distance(halves_a, turns_a, offsets, halves_b, turns_b, np.zeros(3))
    else:
        signed = np.array([
            polytope_signed_distance(a.moved(ta, at), b.moved(tb, np.zeros(3)))
            for (a, b), ta, tb, at in zip(outlines, turns_a, turns_b, offsets, strict=True)
        ])
    for k in np.flatnonzero(signed > 0.0):
        (a, _), (b, _) = points[k]
        a, b = a @ turns_a[k].T + offsets[k], b @ turns_b[k].T
        lower, upper = separated_distance(a, b)
        assert upper - lower <= 1e-10
        signed[k] = upper
    return signed


@pytest.mark.parametrize("regime", REGIMES)
@pytest.mark.parametrize("kind", KINDS)
def test_judge_agrees_with_exact_answers_on_two_thousand_pairs(kind, regime, record_property):
    shapes, points, outlines, judge = gallery(kind)
    rng = np.random.default_rng(sum(map(ord, kind + regime)))
    at_b = np.arange(PAIRS)[:, None] * np.array([SPACING, 0.0, 0.0])
    worst, right_side, asked = 0.0, 0, 0
    # among the shallow ones some miss each other by a hair: draw more, so that 2,000 do overlap
    for _ in range(ROUNDS + 2 if regime == "shallow" else ROUNDS):
        turns = rotation.normalised(rng.normal(size=(2 * PAIRS, 4)))
        matrices = rotation.to_matrix(turns)
        offsets = np.array([
            offset_of(regime, points_a @ matrices[k].T, radius_a, points_b @ matrices[PAIRS + k].T, radius_b, rng)
            for k, ((points_a, radius_a), (points_b, radius_b)) in enumerate(points)
        ])
        # what the judge is given carries the rounding of the place: measure that
        at_a = at_b + offsets
        exact = exact_signed(shapes, points, outlines, matrices[:PAIRS], matrices[PAIRS:], at_a - at_b)
        first, second, found = judge.distances(np.concatenate([at_a, at_b]), turns, REACH)
        judged = np.full(PAIRS, np.nan)
        judged[np.minimum(first, second)] = found
        assert (np.abs(first - second) == PAIRS).all()
        worst = max(worst, float(np.abs(judged - exact).max()))
        assert worst <= PROMISE
        right_side += int(((exact > 0.0) == (regime == "apart")).sum())
        asked += PAIRS
    record_property("worst_error_m", worst)
    print(f"{kind}, {regime}: {asked} pairs, {right_side} of them {regime}, largest error {worst:.2g} m")
    assert right_side >= 2000


@pytest.mark.parametrize("pair", [(sphere, box), (sphere, hull), (capsule, box), (capsule, hull), (box, hull), (plate, hull),
                                  (plate, capsule), (hull, hull), (box, box)])
def test_judge_agrees_with_the_minkowski_difference_on_mixed_kinds(pair):
    rng = np.random.default_rng(7)
    shapes = [(pair[0](rng), pair[1](rng)) for _ in range(30)]
    bodies = [fixed(f"a{k}", (Piece(a),), "wood") for k, (a, _) in enumerate(shapes)]
    bodies += [simulated(f"b{k}", (Piece(b),), "wood", Mass(1.0)) for k, (_, b) in enumerate(shapes)]
    judge = Judge(Scene("mixed", tuple(bodies)))
    turns = rotation.normalised(rng.normal(size=(60, 4)))
    matrices = rotation.to_matrix(turns)
    at_b = np.arange(30)[:, None] * np.array([0.0, SPACING, 0.0])
    at_a, exact = at_b.copy(), np.zeros(30)
    for k, (a, b) in enumerate(shapes):
        (a, radius_a), (b, radius_b) = rounded_points(a), rounded_points(b)
        a, b = a @ matrices[k].T, b @ matrices[30 + k].T
        at_a[k] += offset_of(REGIMES[k % 3], a, radius_a, b, radius_b, rng)
        exact[k] = signed_distance(a + (at_a[k] - at_b[k]), radius_a, b, radius_b)
    first, second, found = judge.distances(np.concatenate([at_a, at_b]), turns, REACH)
    judged = np.full(30, np.nan)
    judged[np.minimum(first, second)] = found
    assert judged == pytest.approx(exact, abs=PROMISE)


@pytest.mark.parametrize("tilt", [0.0, 1e-14, 1e-10, 1e-8, 1e-7, 1e-6, 1e-5, 1e-3])
def test_nearly_aligned_boxes_are_judged_right(tilt):
    rng = np.random.default_rng(11)
    n = 400
    sizes = rng.integers(1, 6, (2 * n, 3)) * 0.05
    bodies = [fixed(f"a{k}", (Piece(Box(tuple(size))),), "wood") for k, size in enumerate(sizes[:n])]
    bodies += [simulated(f"b{k}", (Piece(Box(tuple(size))),), "wood", Mass(1.0)) for k, size in enumerate(sizes[n:])]
    judge = Judge(Scene("aligned", tuple(bodies)))
    turns = np.tile(rotation.IDENTITY, (2 * n, 1))
    turns[n:] = rotation.from_rotation_vector(tilt * rng.normal(size=(n, 3)))
    matrices = rotation.to_matrix(turns)
    at_b = np.arange(n)[:, None] * np.array([4.0, 0.0, 0.0])
    at_a = at_b + rng.integers(-4, 5, (n, 3)) * 0.05
    exact = box_signed_distance(0.5 * sizes[:n], matrices[:n], at_a - at_b, 0.5 * sizes[n:], matrices[n:], np.zeros(3))
    first, second, found = judge.distances(np.concatenate([at_a, at_b]), turns)
    overlapping = found < -PROMISE
    assert set(np.minimum(first, second)[overlapping]) >= set(np.flatnonzero(exact < -2.0 * PROMISE))
    assert found[overlapping] == pytest.approx(exact[np.minimum(first, second)[overlapping]], abs=PROMISE)


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
        judge = Judge(Scene("smooth", (fixed("a", (Piece(shapes[0]),), "wood"),
                                       simulated("b", (Piece(shapes[1]),), "wood", Mass(1.0)))))
        turns = rotation.normalised(rng.normal(size=(2, 4)))
        at = np.array([rng.normal(size=3) * 0.1, np.zeros(3)])
        _, _, found = judge.distances(at, turns, REACH)
        matrices = rotation.to_matrix(turns)
        brute = by_directions(Outline(shapes[0]), matrices[0], Outline(shapes[1]), matrices[1], at[0])
        assert found[0] == pytest.approx(brute, abs=PROMISE)


def test_an_ellipsoid_in_a_floor_is_as_deep_as_its_support_function_says():
    rng = np.random.default_rng(17)
    floor = Piece(Box((20.0, 20.0, 4.0)), (0.0, 0.0, -2.0))
    for _ in range(50):
        radii = rng.uniform(0.03, 0.3, 3)
        judge = Judge(Scene("floor", (fixed("floor", (floor,), "wood"),
                                      simulated("egg", (Piece(Ellipsoid(tuple(radii))),), "wood", Mass(1.0)))))
        turns = np.array([rotation.IDENTITY, rotation.normalised(rng.normal(size=4))])
        height = rng.uniform(-0.1, 0.3)
        lowest = float(np.linalg.norm(radii * rotation.to_matrix(turns[1])[2]))
        verdict = judge.overlaps(np.array([[0, 0, 0], [0, 0, height]]), turns)
        assert verdict.deepest == pytest.approx(max(0.0, lowest - height), abs=PROMISE)


def test_concentric_hulls_are_judged_right():
    for radii in ((0.1, 0.15, 0.2), (0.17, 0.17, 0.18), (0.02, 0.2, 0.2)):
        shape = ellipsoid_hull(radii)
        judge = Judge(Scene("one", (fixed("a", (Piece(shape),), "wood"), simulated("b", (Piece(shape),), "wood", Mass(1.0)))))
        verdict = judge.overlaps(np.zeros((2, 3)), np.tile(rotation.IDENTITY, (2, 1)))
        exact = -signed_distance(shape.vertices, 0.0, shape.vertices, 0.0)
        assert verdict.deepest == pytest.approx(exact, abs=PROMISE)
        # the fast way must find it: brute force behind it would hide that it stopped too early
        assert verdict.decided == 0


def test_a_hull_is_the_box_it_spells_out():
    as_box, as_hull = Box((0.2, 0.3, 0.4)), ConvexHull(rounded_points(Box((0.2, 0.3, 0.4)))[0])
    rng = np.random.default_rng(37)
    for _ in range(20):
        at, turns = rng.uniform(-0.2, 0.2, (2, 3)), rotation.normalised(rng.normal(size=(2, 4)))
        verdicts = [
            Judge(Scene("s", (fixed("a", (Piece(shape),), "wood"), simulated("b", (Piece(Sphere(0.1)),), "wood", Mass(1.0)))))
            .overlaps(at, turns).deepest for shape in (as_box, as_hull)
        ]
        assert verdicts[0] == pytest.approx(verdicts[1], abs=1e-12)
