"""Every kernel finds the near pairs; layouts are as dense and as slow at any size; the command writes its file."""

import csv
from pathlib import Path

import numpy as np
import pytest

from avatarsim.collision.broad_phase import all_pairs
from avatarsim.model.geometry import OPEN, pair_filter
from benchmarks.__main__ import main
from benchmarks.broad_fields import HUGE, LAYOUTS, MOTIONS, NEAR, SWING, field
from benchmarks.broad_phase import KERNELS, NOTHING, SWEEP, Course, measure, one_axis


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_kernel_finds_the_near_pairs(kernel: str, layout: str) -> None:
    for motion in MOTIONS:
        found = measure(layout, motion, kernel, (40, 90), (40, 1, 90))
        assert [row.objects for row in found] == [40, 90]
        assert all(row.found_all and row.near_pairs == NEAR for row in found)


def test_a_sample_is_as_many_whole_swings_at_any_size() -> None:
    """Else a few objects are measured over all of a swing and many over the part where they turn round."""
    for motion in MOTIONS:
        few, many = Course(field("cube", motion, 20), SWEEP, 4000), Course(field("cube", motion, 200), SWEEP, 4000)
        period = few.field.period
        assert few.frames % period == many.frames % period == 0 and few.frames >= 200 and many.frames >= 20
        few.seconds(SWEEP, period)
        # it is back where it began, to a part of a frame's way
        assert np.abs(few.swept[0] - few.field.boxes).max() <= 0.03


def test_moving_alone_moves_the_copy_and_not_the_swept_boxes() -> None:
    """Else the sweep meets boxes that have moved for many frames at once."""
    one = Course(field("cube", "all slow", 30), SWEEP, 1)
    one.seconds(NOTHING, 50)
    assert (one.swept[0] == one.field.boxes).all() and (one.moved[0] != one.field.boxes).any()
    one.seconds(SWEEP, 50)
    assert (one.swept[0] == one.moved[0]).all() and one.memory.sweep[0] == 50


def test_the_sweep_along_one_axis_finds_all_pairs() -> None:
    rng, order = np.random.default_rng(1), np.arange(60)
    for _ in range(20):
        low = rng.uniform(0.0, 5.0, (60, 3))
        boxes = np.hstack([low, low + rng.uniform(0.0, 1.0, (60, 3))])
        found, everything = np.zeros((500, 2), np.int64), np.zeros((500, 2), np.int64)
        wanted = pair_filter(np.where(rng.random(60) < 0.2, 0, OPEN))
        count = all_pairs(boxes, wanted, everything)[1]
        assert one_axis(boxes, wanted, order, found) == count > 0
        assert sorted(found[:count].tolist()) == everything[:count].tolist()


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("count", [20, 200, 601])
def test_five_pairs_are_near_wherever_the_boxes_swing(layout: str, count: int) -> None:
    here = field(layout, "all slow", count)
    assert len(here.boxes) == count and (here.boxes[:, :3] < here.boxes[:, 3:]).all()
    pairs = np.zeros((99, 2), np.int64)
    assert all_pairs(here.boxes, here.wanted, pairs)[1] == NEAR
    # partners move alike, so grown by the swing on all sides the rest must be apart still
    grown = here.boxes + SWING * np.array([-1, -1, -1, 1, 1, 1])
    assert all_pairs(grown, here.wanted, pairs)[1] == NEAR
    speed = np.zeros((count, 3))
    speed[here.moving] = here.speed
    assert all((speed[a] == speed[b]).all() for a, b in pairs[:NEAR])


def test_motions_have_their_share_and_speed() -> None:
    for motion, share, most in (("all slow", 1.0, 0.03), ("all fast", 1.0, 1.05), ("none", 0.0, 0.0)):
        here = field("plane", motion, 300)
        assert len(here.moving) == share * 300 and np.allclose(np.linalg.norm(here.speed, axis=1) * 60.0, most, rtol=0.05)
    assert 5 < len(field("cube", "1 % slow", 2000).moving) < 40
    here = field("mixed", "all slow", 100)
    sizes = np.ptp(here.boxes.reshape(-1, 2, 3), axis=1).max(axis=1)
    assert len(here.moving) == 98 and (np.sort(sizes)[-HUGE:] > 4.0).all()


def test_the_command_writes_its_file(tmp_path: Path) -> None:
    assert main(["broad-phase", "--quick", "--run", str(tmp_path)]) == 0
    rows = list(csv.DictReader((tmp_path / "broad_phase.csv").read_text().splitlines()))
    assert {row["found_all"] for row in rows} == {"True"} and {row["near_pairs"] for row in rows} == {"5"}
    assert {row["kernel"] for row in rows} == set(KERNELS)
