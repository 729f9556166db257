"""Table 2 and Figures 7 and 8 of the paper again: the paper's own rows, and those of a run that has timed the four scenes."""

import argparse
import sys
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from benchmarks.output import print_rows, write_rows
from runfiles.published import MAX_BYTES
from runfiles.record import Recording, load
from scenarios.catalog.paper import TABLE_2 as SCENES
from scenarios.job import Job
from scenarios.measure.posture.tracker_offset import angle_offsets
from scenarios.measure.timing import Timed
from scenarios.run.accuracy import prepare
from scenarios.run.run_files import checked_recording
from scenarios.run.timed_worker import repeat

FIGURE_7, FIGURE_8 = "hand_over_table", "two_arms"
"""The scenes of both figures. The timing pass of a run stops long before the hand first touches the table, so the frames of
Figure 7, 3653 as in the paper, are timed here."""
PRESETS, REPEATS = ("default", "paper"), 3
"""Methods of Figure 7, and runs of which each frame's quickest is taken."""
QUICK_FRAMES = 12
PRINTED = "printed in the paper"
OWN = "avatarsim/"
AWAY = 1e-4
"""Angle [rad] from the user's from which a joint counts as moved: far below the visible, far above rounding."""
WHOLE = "the whole file of a run"


@dataclass(frozen=True)
class Row:
    """One scene in one method: frames run and timed, mean frame time [ms], work per frame, deepest overlap shown [m]; nan
    where it does not apply. Shares [%] are the paper's alone: they are of a frame with drawing and tracker."""

    scene: str
    run: str
    frames: int
    timed: int
    ms: float
    joints: float = nan
    iterations: float = nan
    ik_share: float = nan
    pairs: float = nan
    collision_share: float = nan
    overlap: float = nan


@dataclass(frozen=True)
class FrameRow:
    """One frame of Figure 7 or 8: its time [us], and in Figure 8 its iterations."""

    run: str
    frame: int
    us: float
    iterations: float = nan


@dataclass(frozen=True)
class ShareRow:
    """Share [%] of a stage in all frames of Figure 7."""

    run: str
    stage: str
    share: float


AS_PRINTED = (
    Row("two_arms", PRINTED, 1496, 1496, 14.63, 16, 3, 12.7, 3, 17.4),
    Row("self_collision", PRINTED, 2327, 2327, 15.99, 28, 5, 14.6, 5, 21.1),
    Row("two_arms_and_leg", PRINTED, 2440, 2440, 17.47, 32, 6, 16.7, 6, 24.8),
    Row("arm_in_corner", PRINTED, 2146, 2146, 20.49, 40, 7, 18.5, 13, 31.3),
)
"""The paper's Table 2, on a 1.7 GHz Xeon."""


@dataclass(frozen=True, eq=False)
class Run:
    """One engine and preset in one scene: its recording, times (T,) [us] of the frames that were timed, the deepest overlap."""

    scene: str
    name: str
    recording: Recording
    times: NDArray[np.float64]
    overlap: float

    def mean(self, name: str) -> float:
        """Return the mean of a count over all frames run; nan where the engine does not count it."""
        numbers = self.recording.counts.get(name)
        return float(numbers[1:].mean()) if numbers is not None and len(numbers) > 1 else nan


def runs(folder: Path) -> list[Run]:
    """Return every engine and preset with times in the run, in the scenes of Table 2, seed 0. InvalidFile for damaged results."""
    path = folder / "results.json"
    results: Any = read_json(path, f"results {path}", WHOLE, MAX_BYTES)
    try:
        series = {(scene, name): (_numbers(numbers["frame_time_us"]), _numbers(numbers["overlap_m"]))
                  for scene in SCENES for name, numbers in results["series"].get(scene, {}).items()}
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise InvalidFile(f"results {path}", f"{type(error).__name__}: {error}", WHOLE) from error
    timed = []
    for (scene, name), (times, overlap) in series.items():
        file = name.replace("/", ".")
        # a comparison of many scenes may have timed only frames around contact; the table is of a scene from its start
        recording_path = folder / "recordings" / f"{scene}.{file}.0.npz"
        if times and not isnan(times[0]) and recording_path.exists():
            recording = checked_recording(load(recording_path), recording_path)
            timed.append(Run(scene, name, recording, np.array(times), max(overlap, default=nan)))
    return timed


def _numbers(values: Iterable[float | str | None]) -> list[float]:
    return [nan if value is None else float(value) for value in values]


def row(run: Run) -> Row:
    """Return one line of the table. Where no joint is solved by itself, joints are those that are not where the user's are."""
    made = Row(run.scene, run.name, run.recording.frames, len(run.times), float(run.times.mean()) / 1e3, overlap=run.overlap)
    if not run.name.startswith(OWN):
        return made
    joints = run.mean("joints")
    if isnan(joints):
        scene = prepare(Job(run.scene, OWN[:-1], PRESETS[0], full=bool(run.recording.meta.get("full")))).scene
        joints = float((angle_offsets(run.recording, scene) > AWAY).sum(axis=1).mean())
    return replace(made, joints=joints, iterations=run.mean("iterations"), pairs=run.mean("pairs"))


def table_2(timed: list[Run]) -> list[Row]:
    """Return the paper's rows and those of the runs, scene by scene."""
    rows = []
    for printed in AS_PRINTED:
        if own := [row(run) for run in timed if run.scene == printed.scene]:
            rows += [printed, *own]
    return rows


def figure_8(timed: list[Run]) -> list[FrameRow]:
    """Return frame time and iterations of each timed frame of the two arms, by method."""
    return [
        FrameRow(run.name, k + 1, us, float(iterations)) for run in timed if run.scene == FIGURE_8 and run.name.startswith(OWN)
        for k, (us, iterations) in enumerate(zip(run.times.tolist(), run.recording.counts["iterations"][1:], strict=False))
    ]


def figure_7(frames: int | None = None, repeats: int = REPEATS) -> tuple[list[FrameRow], list[ShareRow]]:
    """Return the time of each frame of the hand over the table, or of the first `frames`, and the share of each stage."""
    rows: list[FrameRow] = []
    shares: list[ShareRow] = []
    for preset in PRESETS:
        job = Job(FIGURE_7, OWN[:-1], preset, full=True, frames=frames)
        count = prepare(job).scenario.frames
        runs = [repeat(job, count) for _ in range(repeats)]
        stages = {name: np.array([stage[name] for _, stage, _ in runs], dtype=np.int64) for name in runs[0][1]}
        timed = Timed(np.array([times for times, _, _ in runs], dtype=np.int64), stages)
        rows += [FrameRow(job.run, k + 1, us) for k, us in enumerate(timed.best_us.tolist())]
        whole = float(timed.engine_ns.sum())
        shares += [ShareRow(job.run, name, 100.0 * float(spent.sum()) / whole) for name, spent in stages.items()]
    return rows, shares


def run(arguments: argparse.Namespace, folder: Path) -> int:
    """Read, write, print. 5: the run has no scene of the table."""
    timed = runs(arguments.of or folder)
    if not timed:
        print(f"the run has timed none of {', '.join(SCENES)}", file=sys.stderr)
        return 5
    print_rows("Table 2 of the paper", table_2(timed))
    write_rows(folder / "table_2.csv", table_2(timed), Row)
    write_rows(folder / "figure_8.csv", figure_8(timed), FrameRow)
    trace, shares = figure_7(*((QUICK_FRAMES, 1) if arguments.quick else ()))
    write_rows(folder / "figure_7.csv", trace, FrameRow)
    write_rows(folder / "figure_7_shares.csv", shares, ShareRow)
    return 0
