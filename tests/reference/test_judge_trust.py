"""The judge's examination: its findings, that a judge at fault is found out, and the file that the report reads."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize

from avatarsim.errors import InvalidInput
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Shape, Sphere
from avatarsim.spatial import rotation
from reference.judge_trust import BOUND, FILE, Trust, counted, main, trust
from reference.judging.in_fcl import fcl_distance, fcl_distances, fcl_geometry
from reference.judging.judge import Judge
from reference.judging.known_pairs import FLOOR, KINDS, REGIMES, Gallery, exact, offset, point_to_ellipsoid

PROMISE = 1e-8
PAIRS = 8 * len(KINDS) * len(REGIMES)


@cache
def found() -> Trust:
    return trust(PAIRS, 7)


def test_the_judge_keeps_its_promise_and_turns_no_verdict() -> None:
    whole = found().whole
    assert whole.pairs == PAIRS and whole.overlapping > PAIRS // 2
    for kind in found().kinds:
        assert kind.largest_error <= PROMISE, kind
    assert whole.false_alarms + whole.misses <= whole.at_the_bound < whole.pairs // 50
    # python-fcl differs often, and the exact answer never sides with it
    assert 0 < whole.disagreements < 0.4 * whole.pairs and whole.judge_wrong == 0
    assert whole.unanswered < whole.pairs // 50


def test_the_same_seed_draws_the_same_pairs() -> None:
    draws = [Gallery("boxes", 3, np.random.default_rng(seed)).placed("deep", np.random.default_rng(seed)) for seed in (1, 1, 2)]
    assert (draws[0].exact == draws[1].exact).all() and (draws[0].exact != draws[2].exact).all()


def test_a_regime_is_as_near_as_it_says() -> None:
    random = np.random.default_rng(3)
    for kind in KINDS:
        gallery = Gallery(kind, 12, random)
        gap = {regime: gallery.placed(regime, random).exact for regime in REGIMES}
        assert (gap["apart"] > 0.9e-9).all() and (gap["apart"] < 1.1e-3).all()
        assert (gap["at the bound"] < 0.0).all() and (gap["at the bound"] > -2.1e-6).all()
        assert (gap["shallow"] > -1.1e-2).all() and (gap["deep"] < 0.0).all()
        assert np.median(gap["deep"]) < np.median(gap["shallow"])


def test_errors_alarms_and_misses_are_counted() -> None:
    truth = np.array([1e-3, -0.5e-6, -2e-6, -2e-6, -1e-3, -BOUND])
    judged = truth + np.array([0.0, -0.9e-6, 1.5e-6, 0.0, 1e-4, 0.0])
    other = truth + np.array([2e-6, 0.0, 0.0, np.nan, 0.0, 0.0])
    told = counted("x", truth, judged, other)
    assert (told.pairs, told.overlapping, told.false_alarms, told.misses, told.at_the_bound) == (6, 5, 1, 1, 1)
    assert told.largest_error == pytest.approx(1e-4) and told.largest_depth_error == pytest.approx(1e-4)
    # the third and the fifth are the judge's own fault, the first is python-fcl's, the fourth is undecided
    assert (told.unanswered, told.disagreements, told.overlapping_disagreements, told.judge_wrong) == (1, 3, 2, 2)


def test_a_judge_that_lies_or_passes_over_a_pair_is_found_out(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    honest = Judge.distances

    def lying(self, *asked):
        first, second, judged = honest(self, *asked)
        return first, second, judged - 1e-4

    def silent(self, *asked):
        first, second, judged = honest(self, *asked)
        return first[1:], second[1:], judged[1:]

    pairs, where = len(KINDS) * len(REGIMES), ["--run", str(tmp_path)]
    monkeypatch.setattr(Judge, "distances", lying)
    whole = trust(pairs, 7).whole
    assert whole.largest_error == pytest.approx(1e-4, rel=1e-3) and whole.false_alarms > 0 and whole.judge_wrong > 0
    monkeypatch.setattr(Judge, "distances", silent)
    assert main([*where, "--pairs", str(pairs)]) == 1
    assert np.isnan(json.loads((tmp_path / FILE).read_text())["all"]["largest_error"])


def test_the_command_writes_what_the_function_found(tmp_path: Path) -> None:
    assert main(["--run", str(tmp_path), "--pairs", str(PAIRS), "--seed", "7"]) == 0
    told = json.loads((tmp_path / FILE).read_text())
    assert told["all"]["pairs"] == PAIRS == sum(kind["pairs"] for kind in told["kinds"])
    assert told["all"]["largest_error"] == found().whole.largest_error and told["seed"] == 7
    assert main(["--pairs", "3"]) == 2 and main(["--seed", "-1"]) == 2
    with pytest.raises(InvalidInput, match="pairs"):
        trust(len(KINDS) - 1)


ENDING = (
    (((0.19343482074269272, 0.44762717445722694, 0.232489177104571),
      (0.4597281919846803, 0.08200121406987902, 0.10721984283615386)),
     (-0.3844925041061728, -0.08203767431572007, 0.44251553337348887, 0.8059871816612278),
     (0.10190060940893848, 0.927676360833275, 0.02849898790850386, 0.35807910165410284),
     (0.1345114576032529, -0.06347689739759975, 0.46176178197261913)),
    (((0.3933642411955542, 0.2486579253392652, 0.47182145662011943),
      (0.2570050126861448, 0.43196758251999356, 0.41131088691972345)),
     (0.2924583682363642, 0.13514567602934835, -0.09282643452737958, 0.9421183588870496),
     (0.7607136106328061, -0.12386295009554579, -0.4041082473347101, -0.49261475478074807),
     (0.45824623332487135, 0.04208946913771935, 0.21967200804529968)),
)
"""Sizes, turns and offset of boxes face to face, drawn at random, on which python-fcl 0.7 ends its process."""


def test_a_process_that_ends_costs_one_answer() -> None:
    sound = (Box((0.2, 0.2, 0.2)), np.eye(3), Sphere(0.1), np.eye(3), np.array([0.0, 0.0, 0.5]))
    ending = [
        (Box(a), rotation.to_matrix(np.array(turn_a)), Box(b), rotation.to_matrix(np.array(turn_b)), np.array(at))
        for (a, b), turn_a, turn_b, at in ENDING
    ]
    told = fcl_distances([sound, *ending, sound])
    assert np.isnan(told[1:-1]).any() and told[0] == told[-1] == pytest.approx(0.3, abs=1e-6)
    assert len(fcl_distances([])) == 0


@pytest.mark.parametrize(("shape", "touch"), [(Sphere(0.2), 0.2), (Capsule(0.1, 0.4), 0.3), (Box((0.2, 0.2, 0.4)), 0.2)])
def test_fcl_measures_along_the_same_axes_and_units(shape: Shape, touch: float) -> None:
    ground = fcl_geometry(Box((4.0, 4.0, 2.0)))
    for height in (0.5, 0.25, 0.15):
        found = fcl_distance(fcl_geometry(shape), np.eye(3), np.array([0.0, 0.0, 1.0 + height]), ground, np.eye(3), np.zeros(3))
        # fcl itself is 0.4 mm off here; a wrong axis or unit would be centimetres
        assert found == pytest.approx(height - touch, abs=1e-3)


def test_point_to_ellipsoid_is_the_least_over_its_surface() -> None:
    random = np.random.default_rng(5)
    assert point_to_ellipsoid(np.array([0.5, 0.0, 0.0]), np.full(3, 0.2)) == pytest.approx(0.3, abs=1e-15)
    for _ in range(30):
        radii = random.uniform(0.03, 0.3, 3)
        point = random.normal(size=3) * random.choice([0.02, 0.1, 0.5])

        def apart(angles: np.ndarray | tuple[float, float], point: np.ndarray = point, radii: np.ndarray = radii) -> float:
            a, b = angles
            return float(np.linalg.norm(radii * [np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)] - point))

        grid = [(a, b) for a in np.linspace(-3.1, 3.1, 25) for b in np.linspace(-1.5, 1.5, 13)]
        starts = sorted(grid, key=apart)[:4]
        fine = {"xatol": 1e-10, "fatol": 1e-14}
        least = min(minimize(apart, start, method="Nelder-Mead", options=fine).fun for start in starts)
        inside = ((point / radii) ** 2).sum() < 1.0
        assert point_to_ellipsoid(point, radii) == pytest.approx(-least if inside else least, abs=1e-9)


def test_ellipsoids_have_closed_forms_with_balls_and_floors() -> None:
    turn = rotation.to_matrix(rotation.normalised(np.array([1.0, 0.2, 0.3, 0.1])))
    egg, up = Ellipsoid((0.1, 0.2, 0.3)), np.array([0.0, 0.0, 1.0])
    lowest = float(np.linalg.norm(np.array(egg.radii) * turn[2]))
    assert exact(egg, turn, Box(FLOOR), np.eye(3), 0.9 * up) == pytest.approx(0.4 - lowest, abs=1e-15)
    place = offset("apart", egg, turn, Sphere(0.1), np.eye(3), up, np.random.default_rng(1))
    assert 0.0 < exact(egg, turn, Sphere(0.1), np.eye(3), place) < 1.1e-3
    with pytest.raises(TypeError, match="closed form"):
        exact(egg, turn, Box((1.0, 1.0, 1.0)), np.eye(3), up)
