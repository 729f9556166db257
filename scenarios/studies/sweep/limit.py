"""Self-convergence: each engine against its own run at an eighth of the smallest step, in scenes without a closed form.

An engine whose runs approach one another as its steps shrink is consistent. Whether what they approach is right is another
question: what that finest run leaves of overlap and beyond the limits, and how far it is from the finest runs of the others.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import FrameRecord
from avatarsim.errors import described
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from runfiles.files import write_whole
from scenarios.engines import STEPPED, opened
from scenarios.job import Job
from scenarios.measure.posture.limits import limit_excess
from scenarios.results.store import Entry
from scenarios.running.run import gathered
from scenarios.studies.sweep import finer

Array = NDArray[np.float64]

SCENES = ("mocap_punch_wall", "hand_grasp", "hand_in_corner_rigid")
"""Of the telling scenes those without a closed form in which things move that do not come to rest."""
RATES = (60, 120, 240, 480, 960)
"""Steps per second that are compared."""
FINEST = 8 * RATES[-1]
"""Steps per second of the run that they are compared with."""
RENDERED = 60
"""Rendered frames per second of these scenes."""


@dataclass(frozen=True)
class Row:
    """How far the shown poses at `rate` steps per second are from the engine's own finest run, root mean square over frames and
    moving bodies and largest [m]; what it leaves of overlap [m] and beyond limits [deg]; and how far it is from our own finest
    run [m]. nan with the reason in `note`."""

    scenario: str
    engine: str
    preset: str
    rate: int
    off: float
    off_max: float
    overlap: float
    beyond: float
    from_ours: float
    note: str


def job_of(scenario: str, engine: str, preset: str, rate: int, full: bool = False, frames: int | None = None) -> Job:
    """An engine at so many steps per second, by its own time step or by cutting frames."""
    name, cut = f"{preset}.{rate}", rate // RENDERED
    if engine in STEPPED:
        return Job(scenario, engine, name, 0, full, frames, preset, {"dt": 1.0 / rate})
    within = None if frames is None else frames * cut
    return Job(finer.name_of(scenario, cut), engine, name, 0, full, within, preset, {}, finer.__name__)


def ran(job: Job, to: Path) -> Entry:
    """Run `job`; poses at rendered frames go to `to` (whole or not at all), what it leaves into the entry."""
    from reference.judging.judge import Judge

    scenario, scene, motion = job.asked()
    samples = [motion(k) for k in range(scenario.frames)]
    engine, cut = opened(job.engine), round(1.0 / RENDERED / scenario.dt)
    frames: list[FrameRecord] = []
    try:
        frames.append(engine.load(scene, job.settings(engine), scenario.dt))
        frames += [engine.advance(sample, scenario.dt) for sample in samples]
    except Exception as error:
        # an engine that raises has that for its result
        return {"run": job.run, "note": f"in frame {len(frames)}: {described(error)}", "overlap": None, "beyond": None}
    finally:
        engine.close()
    kept = slice(None, None, cut)
    recording = gathered(job, scenario, scene, [scene.first_sample, *samples][kept], frames[kept], {})
    judge = Judge(scene.whole)
    depth = judge.depths(recording.positions, recording.orientations)
    beyond = limit_excess(recording, scene.whole).get("joint_limit_excess_max", 0.0)
    write_whole(to, lambda file: np.save(file, recording.positions))
    return {"run": job.run, "note": "", "overlap": float(np.max(depth)), "beyond": beyond}


def moving(scene: Scene) -> list[int]:
    """Places of all that moves, in canonical order."""
    return [k for k, role in enumerate(scene.roles) if role is not Role.FIXED]


def distance(a: Array, b: Array, bodies: Sequence[int]) -> tuple[float, float]:
    """Root mean square and largest distance [m] of the same bodies in the same frames of two runs (F, n, 3)."""
    frames = min(len(a), len(b))
    apart = np.linalg.norm(a[:frames, list(bodies)] - b[:frames, list(bodies)], axis=-1)
    return float(np.sqrt(np.mean(apart**2))), float(np.max(apart))


def rows(scenario: str, scene: Scene, entries: Mapping[tuple[str, str, int], tuple[Entry, Array | None]]) -> list[Row]:
    """The rows of one scene from what is known of each (engine, preset, rate)."""
    bodies, found = moving(scene), []
    ours = next((poses for (engine, _, rate), (_, poses) in entries.items() if engine not in STEPPED and rate == FINEST), None)
    for (engine, preset, rate), (entry, poses) in entries.items():
        own = entries.get((engine, preset, FINEST), ({}, None))[1]
        nothing = (math.nan, math.nan)
        off, off_max = nothing if poses is None or own is None else distance(poses, own, bodies)
        from_ours = nothing if poses is None or ours is None else distance(poses, ours, bodies)
        overlap, beyond = (math.nan if entry[name] is None else float(entry[name]) for name in ("overlap", "beyond"))
        row = Row(scenario, engine, preset, rate, off, off_max, overlap, beyond, from_ours[0], str(entry["note"]))
        found.append(row if poses is None or own is not None else replace(row, note="its finest run is missing"))
    return found


def order(steps: Sequence[Row]) -> float:
    """The power of the step with which the distance falls: slope through the logarithms; nan with fewer than two."""
    points = [(math.log(1.0 / row.rate), math.log(row.off)) for row in steps if row.rate < FINEST and row.off > 0.0]
    if len(points) < 2:
        return math.nan
    x, y = np.array(points).T
    return float(np.polyfit(x, y, 1)[0])
