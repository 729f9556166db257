"""The oracles of judged.py against qhull, least squares, closed forms and each other, and that they do notice wrong answers."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision import status
from reference.judging.minkowski import separated_distance, signed_distance
from tests.collision import judged
from tests.collision.forms import KINDS, draw_form, draw_spot
from tests.collision.greatest_gap import greatest_gap
from tests.collision.judged import RELATIVE, judge
from tests.collision.least_distance import least_distance, outside
from tests.collision.proved_depth import make_stack, proved_depth
from tests.collision.strata import BATCH, PLACES, STRATA, Form, draw, packed

STACK = make_stack()


def batch_of(a, rows_a, b, rows_b):
    """One pair."""
    return packed([(rows_a, a, rows_b, b)], np.zeros((1, 3)), ["pair"])


def features(batch):
    return batch.centred, batch.shapes.start, batch.face, batch.face_start, batch.edge, batch.edge_start


def depth_by_cutting(batch, claim=np.inf, tolerance=1e-10):
    rows, shapes = batch.centred, batch.shapes
    return proved_depth(rows, shapes.kind, shapes.start, 0, 1, claim, tolerance, 300_000, STACK)


def ball_form():
    return draw_form("sphere", "plump", np.random.default_rng(0))


def ellipsoid_form(*axes):
    none = np.zeros((0, 3), np.int64), np.zeros((0, 4), np.int64)
    return Form("ellipsoid", np.vstack([np.zeros(3), np.diag(axes)]), 0.0, *none)


def test_three_depths_and_two_distances_agree_on_polytopes():
    rng = np.random.default_rng(1)
    overlapping = 0
    for k in range(60):
        a, b = (draw_form(kind, ("plump", "plate", "needle")[k % 3], rng, (4, 20)) for kind in ("hull", ("box", "hull")[k % 2]))
        turns = Rotation.random(2, rng=rng).as_matrix()
        rows_a, rows_b = a.rows @ turns[0].T + rng.normal(size=3) * rng.choice([0.01, 0.1, 0.5]), b.rows @ turns[1].T
        batch = batch_of(a, rows_a, b, rows_b)
        gap, expected = greatest_gap(*features(batch), 0, 1), signed_distance(rows_a, 0.0, rows_b, 0.0)
        if expected < 0.0:
            overlapping += 1
            assert gap == pytest.approx(expected, abs=1e-13)
            certain, depth = depth_by_cutting(batch, claim=-gap)
            assert certain
            assert depth == pytest.approx(-expected, abs=1.1e-10)
        else:
            lower, upper = separated_distance(rows_a, rows_b)
            apart = least_distance(*features(batch), 0, 1)
            assert gap <= apart + 1e-13
            assert apart == pytest.approx(upper, abs=1e-11)
            assert apart == pytest.approx(lower, abs=1e-11)
    assert 15 < overlapping < 50


def test_depths_of_concentric_ellipsoids_whose_axes_agree_are_sums_of_axes():
    for axes, others in (
        ((0.5, 0.3, 0.2), (0.4, 0.3, 0.1)),
        ((0.5, 0.48, 0.47), (0.3, 0.3, 0.299)),
        ((0.5, 5e-4, 4e-4), (0.3, 4e-4, 3e-4)),
        ((0.5, 0.4, 5e-4), (0.4, 0.4, 3e-4)),
    ):
        turn = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
        a, b = ellipsoid_form(*axes), ellipsoid_form(*others)
        certain, depth = depth_by_cutting(batch_of(a, a.rows @ turn.T, b, b.rows @ turn.T))
        assert certain
        assert depth == pytest.approx(axes[2] + others[2], abs=1.1e-10)


def test_the_proof_gives_up_where_every_direction_is_as_good():
    a = ellipsoid_form(0.5, 0.5, 0.5)
    certain, depth = depth_by_cutting(batch_of(a, a.rows, a, a.rows))
    assert not certain
    assert depth == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("claim", [0.3 + 1e-9, 0.31, 0.9])
def test_a_claim_that_is_too_great_is_corrected(claim):
    a, b = ellipsoid_form(0.5, 0.3, 0.2), ellipsoid_form(0.4, 0.3, 0.1)
    certain, depth = depth_by_cutting(batch_of(a, a.rows, b, b.rows), claim=claim)
    assert certain
    assert depth == pytest.approx(0.3, abs=1.1e-10)


def test_distance_of_points_from_shapes():
    rng = np.random.default_rng(3)
    for kind in KINDS:
        for outline in ("plump", "plate", "needle"):
            form = draw_form(kind, outline, rng)
            core = Form(form.kind, form.rows, 0.0, form.faces, form.edges)
            batch = batch_of(core, core.rows, ball_form(), np.zeros((1, 3)))
            for feature in ("face", "edge", "corner"):
                spot = draw_spot(core, feature, rng)
                for height in (1e-9, 1e-4, 0.3):
                    p = tuple((spot.point + height * spot.normal).tolist())
                    found = outside(batch.centred, batch.shapes.kind, *features(batch)[1:], 0, p)
                    slack = 0.05 * height if kind == "ellipsoid" and height < 1e-8 else 1e-12
                    # for an ellipsoid it is only promised not to be too small
                    assert found >= height - 1e-12
                    assert found <= height + slack or (kind == "ellipsoid" and height > 1e-8)
                middle = core.rows[0] if kind == "ellipsoid" else core.rows.mean(axis=0)
                inside = tuple((0.99 * spot.point + 0.01 * middle).tolist())
                if kind in ("box", "hull", "ellipsoid"):
                    assert outside(batch.centred, batch.shapes.kind, *features(batch)[1:], 0, inside) == 0.0


@pytest.mark.parametrize("stratum", STRATA)
def test_a_stratum_is_drawn_the_same_again_and_is_what_it_says(stratum):
    first, again = draw(stratum, 5, 2), draw(stratum, 5, 2)
    np.testing.assert_array_equal(first.vertices, again.vertices)
    assert first.label == again.label and len(first.label) == BATCH
    assert np.isfinite(first.vertices).all()
    counts = np.diff(first.shapes.start)
    assert counts.max() <= 64 if stratum != "large" else 64 < counts.max() <= 300
    # moving both shapes to the origin lost no bit
    rows, centre = first.shapes.start, first.centre
    for k in range(BATCH):
        here = slice(rows[2 * k], rows[2 * k] + 1)
        np.testing.assert_array_equal(first.centred[here] + centre[k], first.vertices[here])
    assert (np.abs(first.vertices).max() > 9e4) == (stratum in ("far", "smooth-deep"))


def test_the_places_overlap_or_not_as_named():
    for place in PLACES:
        gaps = np.array([gap_of(draw(place, 1, 0), k) for k in range(BATCH)])
        if place == "apart":
            assert (gaps > 0.0).all()
        elif place == "shallow":
            assert (gaps < 0.0).all()
        elif place in ("deep", "concentric"):
            assert (gaps < 0.0).mean() > 0.8
        else:
            assert (np.abs(gaps) < 1e-2).mean() > 0.4 and 0.1 < (gaps > 0.0).mean() < 0.9


def gap_of(batch, k):
    """What the query says of pair k."""
    return judged.signed_distance(batch.vertices, batch.shapes, 2 * k, 2 * k + 1, (0.0, 0.0, 0.0), judged.SCRATCH)[1]


@pytest.mark.parametrize("stratum", ["apart", "shallow", "deep", "flush", "grazing"])
@pytest.mark.parametrize("fault", ["gap", "normal", "points", "status", "sign", "nan"])
def test_a_wrong_answer_is_noticed(stratum, fault, monkeypatch):
    honest = judged.signed_distance

    def lies(vertices, shapes, a, b, seed, scratch):
        code, gap, n, on_a, on_b = honest(vertices, shapes, a, b, seed, scratch)
        size = max(shapes.extent[a], shapes.extent[b])
        if fault == "gap":
            gap += 3.0 * RELATIVE * size
        if fault == "normal":
            turned = np.array(n) + 1e-3 * np.cross(n, (0.3, 0.5, 0.7))
            n = tuple((turned / np.linalg.norm(turned)).tolist())
        if fault == "points":
            on_a = (on_a[0] + 3.0 * RELATIVE * size, on_a[1], on_a[2])
        if fault == "sign":
            gap = -gap
        if fault == "nan":
            gap = np.nan
        return (status.OUT_OF_ITERATIONS if fault == "status" else code), gap, n, on_a, on_b

    monkeypatch.setattr(judged, "signed_distance", lies)
    batch = draw(stratum, 2, 0)
    noticed = [bool(judge(batch, k).failures) for k in range(BATCH)]
    if fault in ("normal", "sign"):
        # two balls have any normal as far as overlap goes only if they are concentric; a gap of 1e-12 has either sign
        assert np.mean(noticed) > (0.4 if stratum in ("flush", "grazing") else 0.99)
    else:
        assert all(noticed)
