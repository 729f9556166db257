"""The spread over orders of the chains: injected figures come out, and the real scene differs in one method alone."""

import csv
from pathlib import Path

import numpy as np
import pytest

from avatarsim.spatial import rotation
from scenarios.spread.__main__ import line, main
from scenarios.spread.orders import from_mean, spread


def test_runs_that_are_the_same_have_no_spread() -> None:
    random = np.random.default_rng(0)
    positions, turns = random.normal(size=(1, 3, 2, 3)), rotation.normalised(random.normal(size=(1, 3, 2, 4)))
    found = spread("x", np.tile(positions, (4, 1, 1, 1)), np.tile(turns, (4, 1, 1, 1)), positions[0], ["a"] * 4, 0.0)
    assert (found.orders, found.different, found.distance_max, found.offset_most) == (4, 1, 0.0, 0.0)
    assert found.angle_max < 1e-5 and line(found).endswith("all the same to the bit")


def test_an_injected_spread_comes_out() -> None:
    # two runs, one link, one frame: 2 cm apart, 6 degrees apart; the user is where the first run is
    positions = np.array([[[[0.0, 0.0, 0.0]]], [[[0.02, 0.0, 0.0]]]])
    turns = rotation.from_axis_angle([0.0, 0.0, 1.0], np.radians([[[1.0]], [[7.0]]]))
    # a quaternion and its negative are one rotation
    turns[1] *= -1.0
    found = spread("x", positions, turns, positions[0], ["a", "b"], 1e-7)
    assert (found.different, found.overlap_max) == (2, 1e-7)
    assert (found.distance_rms, found.distance_max) == pytest.approx((0.01, 0.01))
    assert (found.angle_rms, found.angle_max) == pytest.approx((3.0, 3.0))
    assert (found.offset_least, found.offset_median, found.offset_most) == pytest.approx((0.0, 0.01, 0.02))
    assert from_mean(positions, turns)[1].shape == (2, 1, 1)


def test_the_order_matters_to_the_paper_and_not_to_the_default(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--run", str(tmp_path), "--orders", "4"]) == 0
    rows = {row["preset"]: row for row in csv.DictReader((tmp_path / "chain_order.csv").read_text().splitlines())}
    assert rows["default"]["different"] == "1" and rows["default"]["distance_max"] == "0"
    assert int(rows["paper"]["different"]) > 1 and float(rows["paper"]["distance_max"]) > 0.0
    assert all(float(row["overlap_max"]) <= 1e-6 for row in rows.values())
    assert "all the same" in capsys.readouterr().out
    assert main(["--orders", "0"]) == 2
