"""Times of rendered frames from those of their parts, and groups with all engines."""

import numpy as np
import pytest

from runfiles.timing_protocol import PHASE_FRAMES
from scenarios.job import Job
from scenarios.measure.timing import Timed
from scenarios.run.timed_worker import TimedWorkers as Seats
from scenarios.run.timing import Clocked
from scenarios.studies.settings.cell import Cell
from scenarios.studies.settings.clock import AT_ONE_TABLE, REPEATS, tables, time_entry, times
from scenarios.studies.settings.grid import Setting
from tests.scenarios.studies.settings.grids import GRIDS


def test_an_entry_has_percentiles_or_a_reason() -> None:
    job = Job("stop_distance", "mujoco", "tuned")
    timed = Timed(np.array([[4000, 2000, 8000, 1000], [3000, 5000, 6000, 1000]], dtype=np.int64))
    found = time_entry(Clocked(job, timed, "2 repeats"), 2)
    # minimum of the repeats: 3, 2, 6, 1 us; rendered: 5 and 7 us
    assert found["p50"] == pytest.approx(6.0) and (found["repeats"], found["frames"]) == (2, 2)
    none = time_entry(Clocked(job, None, "it died"), 1)
    assert none["note"] == "it died" and none["p50"] is None and (none["repeats"], none["frames"]) == (0, 0)


def test_rest_and_motion_have_medians_where_both_are_many() -> None:
    job, still = Job("stop_distance", "mujoco", "tuned"), PHASE_FRAMES
    timed = Timed(np.array([[9000] * (still + 10) + [1000] * still], dtype=np.int64))
    found = time_entry(Clocked(job, timed), 1, [0] * (still + 10) + [1] * still)
    assert (found["moving"], found["at_rest"], found["rests"]) == (9.0, 1.0, pytest.approx(100.0 * still / (2 * still + 10)))
    few = time_entry(Clocked(job, timed), 1, [0] * (still + 11) + [1] * (still - 1))
    assert few["moving"] is None and few["rests"] == pytest.approx(100.0 * (still - 1) / (2 * still + 10))
    unknown = time_entry(Clocked(job, timed), 1)
    assert unknown["rests"] is None and unknown["moving"] is None
    # a rendered frame is at rest if all its parts are
    halves = time_entry(Clocked(job, Timed(np.full((1, 4), 2000, dtype=np.int64))), 2, [1, 1, 1, 0])
    assert halves["rests"] == 50.0 and halves["p95"] == 4.0


def test_every_group_has_every_engine() -> None:
    cells = [Cell("stop_distance", setting) for settings in GRIDS.values() for setting in settings]
    groups = tables(cells)
    assert sorted(cell.setting.run for group in groups for cell in group) == sorted(cell.setting.run for cell in cells)
    assert all(len(group) <= AT_ONE_TABLE for group in groups)
    assert all({cell.setting.engine for cell in group} == set(GRIDS) for group in groups[:-1])


def test_processes_go_on_from_table_to_table() -> None:
    cells = [Cell("stop_distance", Setting("mujoco", preset, preset), frames=4) for preset in ("default", "tuned")]
    kept: dict[str, dict[str, object]] = {}
    processes: list[dict[str, object]] = []
    with Seats() as seats:
        for _ in range(2):
            times(cells, seats, lambda cell, entry: kept.update({cell.job.preset: dict(entry)}), [REPEATS, REPEATS])
            processes.append({name: seat.child.pid for name, seat in seats.taken.items()})
    assert processes[0] == processes[1] and set(processes[0]) == {"mujoco 0", "mujoco 1"}
    assert set(kept) == {"default", "tuned"} and all(float(str(entry["p50"])) > 0.0 for entry in kept.values())
    assert {str(entry["note"]) for entry in kept.values()} == {f"{REPEATS} x 4 frames, 4 warm-up frames"}
