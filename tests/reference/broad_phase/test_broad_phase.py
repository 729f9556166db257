"""The benchmark finds the pairs of the twin with every kernel, writes its file, and says where growth is not flat."""

import csv
from pathlib import Path

import numpy as np
import pytest

from avatarsim.collision.broad_phase import all_pairs
from avatarsim.model.geometry import OPEN, pair_filter
from reference.broad_phase import __main__ as broad_phase
from reference.broad_phase.clock import KERNELS, NOTHING, SWEEP, course, frames_of, measure, swing_of
from reference.broad_phase.layouts import LAYOUTS, MOTIONS, NEAR, field
from reference.broad_phase.one_axis import one_axis
from reference.broad_phase.rows import Row, csv_text, growth
from reference.broad_phase.table import table, verdict


def row(objects: int, us: float, held: float = 200.0, right: bool = True, motion: str = "none") -> Row:
    return Row("cube", motion, objects, "sweep and prune", us, held, 5, right)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_kernel_finds_the_near_pairs(kernel: str, layout: str) -> None:
    for motion in MOTIONS:
        fields = [field(layout, motion, count) for count in (40, 90)]
        found = measure(fields, layout, motion, kernel, 40, 1, 90)
        assert [row.objects for row in found] == [40, 90]
        for row in found:
            assert row.found_is_twin and row.near_pairs == NEAR and row.bytes_per_object > 0.0


def test_a_sample_is_as_many_whole_swings_at_any_size() -> None:
    """Else a few objects are measured over all of a swing and many over the part where they turn round."""
    for motion in MOTIONS:
        few, many = field("cube", motion, 20), field("cube", motion, 200)
        swing = swing_of(few)
        assert frames_of(few, SWEEP, 4000) % swing == frames_of(many, SWEEP, 4000) % swing == 0
        assert frames_of(few, SWEEP, 4000) >= 200 and frames_of(many, SWEEP, 4000) >= 20
        one = course(few, SWEEP)
        one.seconds(SWEEP, swing)
        # it is back where it began, to a part of a frame's way
        assert np.abs(one.swept[0] - few.boxes).max() <= 0.03


def test_moving_alone_moves_a_double_and_not_what_is_swept() -> None:
    """Else the sweep meets boxes that have moved for many frames at once."""
    one = course(field("cube", "all slow", 30), SWEEP)
    one.seconds(NOTHING, 50)
    assert (one.swept[0] == one.field.boxes).all() and (one.moved[0] != one.field.boxes).any()
    one.seconds(SWEEP, 50)
    assert (one.swept[0] == one.moved[0]).all() and one.memory.sweep[0] == 50


def test_the_plain_sweep_finds_what_trying_all_finds() -> None:
    rng, order = np.random.default_rng(1), np.arange(60)
    for _ in range(20):
        low = rng.uniform(0.0, 5.0, (60, 3))
        boxes = np.hstack([low, low + rng.uniform(0.0, 1.0, (60, 3))])
        found, twin = np.zeros((500, 2), np.int64), np.zeros((500, 2), np.int64)
        wanted = pair_filter(np.where(rng.random(60) < 0.2, 0, OPEN))
        count = all_pairs(boxes, wanted, twin)[1]
        assert one_axis(boxes, wanted, order, found) == count > 0
        assert sorted(found[:count].tolist()) == twin[:count].tolist()


def test_growth_names_the_worst_number_of_objects() -> None:
    rows = [row(20, 0.01), row(200, 0.03), row(2000, 0.02)]
    assert growth(rows, "us_per_object_p50") == (pytest.approx(3.0), 200, 20)
    assert verdict(rows) == "time x3.00, memory x1.00: not flat, worst at 200"
    assert verdict(rows[::2]) == "time x2.00, memory x1.00: flat"
    assert verdict([row(20, 1.0, 100.0), row(60, 1.0, 300.0)]) == "time x1.00, memory x3.00: not flat, worst at 60"
    assert growth([row(20, -1e-9), row(60, 1.0)], "us_per_object_p50")[0] == np.inf
    assert verdict([row(20, 1.0, motion="all fast")]).endswith("flat (not claimed)")


def test_the_table_names_wrong_pairs() -> None:
    assert "WRONG PAIRS: cube, none, 60 objects, sweep and prune" in table([row(20, 1.0), row(60, 1.0, right=False)])


def test_the_command_writes_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert broad_phase.main(["--quick", "--run", str(tmp_path / "run")]) == 0
    with (tmp_path / "run" / "broad_phase.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == csv_text([row(20, 1.0)]).splitlines()[0].split(",")
    assert {one["found_is_twin"] for one in rows} == {"True"} and {one["near_pairs"] for one in rows} == {"5"}
    assert "ns per object" in capsys.readouterr().out
