"""The rows of Table 2, the paper's own beside those of a run, and the trace of Figure 8."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from reference.frame_shares.measure import Shares, measured
from runfiles.published import MOST_BYTES
from runfiles.record import Recording, load
from scenarios.measure.posture.tracker_offset import angle_offsets
from scenarios.results.kept import as_recorded, fitting, scenes_of
from scenarios.table_2.printed import SCENES

Array = NDArray[np.float64]

TRACE = "two_arms"
"""The scene of Figure 8."""
PRINTED = "printed in the paper"
OURS = "avatarsim"
AWAY = 1e-4
"""Angle [rad] from the user's from which a joint counts as moved: far below what can be seen, far above rounding."""
WHOLE = "the whole file of a run"
REPEATS = 3
"""Runs of which each frame's quickest is taken."""


@dataclass(frozen=True)
class Row:
    """One scene in one method: frames run and timed, frame time [ms] mean and [us] p50 and p99, work per frame, shares of the
    frame [%] (the compiled frame alone: drawing and trackers are not ours to time), cost [us] of IK per joint and per iteration,
    of collision per pair and per query, the deepest overlap shown [m]. nan where it does not apply."""

    scene: str
    run: str
    frames: int
    timed: int
    ms: float
    p50: float = math.nan
    p99: float = math.nan
    joints: float = math.nan
    iterations: float = math.nan
    pairs: float = math.nan
    queries: float = math.nan
    ik_share: float = math.nan
    collision_share: float = math.nan
    posing_share: float = math.nan
    us_per_joint: float = math.nan
    us_per_iteration: float = math.nan
    us_per_pair: float = math.nan
    us_per_query: float = math.nan
    overlap: float = math.nan


AS_PRINTED = (
    Row("two_arms", PRINTED, 1496, 1496, 14.63, joints=16, iterations=3, pairs=3, ik_share=12.7, collision_share=17.4),
    Row("self_collision", PRINTED, 2327, 2327, 15.99, joints=28, iterations=5, pairs=5, ik_share=14.6, collision_share=21.1),
    Row("two_arms_and_leg", PRINTED, 2440, 2440, 17.47, joints=32, iterations=6, pairs=6, ik_share=16.7, collision_share=24.8),
    Row("arm_in_corner", PRINTED, 2146, 2146, 20.49, joints=40, iterations=7, pairs=13, ik_share=18.5, collision_share=31.3),
)
"""The paper's Table 2: a 1.7 GHz Xeon, drawing and reading the tracker included in the frame."""


@dataclass(frozen=True, eq=False)
class Run:
    """What one engine and preset left of one scene: its recording, the times (T,) [us] of the frames that all were timed over,
    and the 99th percentile [us] of all its own; nan where those were too few for one."""

    scene: str
    name: str
    recording: Recording
    times: Array
    overlap: float
    p99: float = math.nan

    @property
    def counts(self) -> dict[str, Array]:
        """Work by name in the frames that were timed."""
        return {name: numbers[1 : 1 + len(self.times)].astype(np.float64) for name, numbers in self.recording.counts.items()}

    def mean(self, name: str) -> float:
        """Mean of a count over all frames run; nan where the engine does not count it."""
        numbers = self.recording.counts.get(name)
        return float(numbers[1:].mean()) if numbers is not None and len(numbers) > 1 else math.nan


def _numbers(values: Iterable[float | str | None]) -> list[float]:
    return [math.nan if value is None else float(value) for value in values]


def runs(folder: Path) -> list[Run]:
    """Every engine and preset with times in the run, in the scenes of Table 2, seed 0."""
    path = folder / "results.json"
    results: Any = read_json(path, f"results {path}", WHOLE, MOST_BYTES)
    try:
        tails = {(row["scenario"], f"{row['engine']}/{row['preset']}"): float(row["value"]) for row in results.get("rows", ())
                 if row["metric"] == "frame_time_p99" and row["seed"] == 0 and row["value"] is not None}
        series = {(scene, name): (_numbers(numbers["frame_time_us"]), _numbers(numbers["overlap_m"]))
                  for scene in SCENES for name, numbers in results["series"].get(scene, {}).items()}
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise InvalidFile(f"results {path}", f"{type(error).__name__}: {error}", WHOLE) from error
    found = []
    for (scene, name), (times, overlap) in series.items():
        who = name.replace("/", ".")
        # a comparison of many scenes may have timed only frames around contact; the table is of a scene from its start
        if times and not math.isnan(times[0]) and scene in scenes_of(folder, who):
            kept = folder / "recordings" / f"{scene}.{who}.0.npz"
            recording = fitting(load(kept), kept)
            deepest, p99 = max(overlap, default=math.nan), tails.get((scene, name), math.nan)
            found.append(Run(scene, name, recording, np.array(times, dtype=np.float64), deepest, p99))
    return found


def shares_of(run: Run, repeats: int = REPEATS) -> Shares:
    """Where the time of our frames goes, in a run of its own with clocks inside the frame, over the frames that were timed."""
    scenario = as_recorded(run.scene, run.recording)
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    samples = [motion(k) for k in range(len(run.times))]
    return measured(scene, samples, scenario.dt, run.name.removeprefix(f"{OURS}/"), repeats=repeats)


def joints_away(run: Run) -> float:
    """Joints per frame that are not where the user's are: what stands for Table 2's joints where no joint is solved by itself."""
    scene = as_recorded(run.scene, run.recording).build()
    return float((angle_offsets(run.recording, scene) > AWAY).sum(axis=1).mean())


def row(run: Run, shares: Shares | None) -> Row:
    """One line of the table; without `shares` what a recording and its times say."""
    common = Row(
        run.scene, run.name, run.recording.frames, len(run.times), float(run.times.mean()) / 1e3, float(np.median(run.times)),
        run.p99, overlap=run.overlap,
    )
    if not run.name.startswith(f"{OURS}/"):
        return common
    joints = run.mean("joints") if "joints" in run.recording.counts else joints_away(run)
    counted = replace(
        common, joints=joints, iterations=run.mean("iterations"), pairs=run.mean("pairs"), queries=run.mean("queries"),
    )
    if shares is None:
        return counted
    counts = run.counts

    def each(part: str, name: str) -> float:
        many = float(counts[name].sum()) if name in counts else 0.0
        return float(shares.us[part].sum()) / many if many > 0.0 else math.nan

    return replace(
        counted, ik_share=shares.share("ik"), collision_share=shares.share("collision"), posing_share=shares.share("posing"),
        us_per_joint=each("ik", "joints"), us_per_iteration=each("ik", "iterations"),
        us_per_pair=each("collision", "pairs"), us_per_query=each("collision", "queries"),
    )


def rows(folder: Path, clocks: bool = True) -> list[Row]:
    """The paper's rows and those of a run, scene by scene; empty when the run has none of the scenes. With `clocks` ours are run
    again for the shares of their parts. Raises InvalidInput where the processor has no cycle counter for that."""
    found = runs(folder)
    lines = {
        (run.scene, run.name): row(run, shares_of(run) if clocks and run.name.startswith(f"{OURS}/") else None) for run in found
    }
    return [
        line for scene in SCENES if any(run.scene == scene for run in found)
        for line in (
            *(printed for printed in AS_PRINTED if printed.scene == scene),
            *(lines[run.scene, run.name] for run in found if run.scene == scene),
        )
    ]


def trace(folder: Path) -> dict[str, Mapping[str, Array]]:
    """Figure 8: by method of ours, frame time [us] and iterations of each timed frame of the two arms."""
    return {
        run.name: {"us": run.times, "iterations": run.counts["iterations"]} for run in runs(folder)
        if run.scene == TRACE and run.name.startswith(f"{OURS}/")
    }
