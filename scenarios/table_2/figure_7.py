"""Figure 7 again: the time of every frame of the hand over the table, at the paper's 3653 frames, and when it is in contact.

The timing pass of a run stops long before the hand first touches the table, so these frames are timed here, on their own."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.tracker import link_poses
from scenarios.job import Job
from scenarios.measure.timing import Timed
from scenarios.running.seat import repeat

SCENE, PRESETS = "hand_over_table", ("default", "paper")
REPEATS = 3
"""Runs of which each frame's quickest is taken."""
SEEN = 1e-6
"""Overlap [m] of the raw hand with a fixed body from which it is in contact."""


@dataclass(frozen=True, eq=False)
class Trace:
    """One method: frame time [us] (F,), whether the raw hand is inside something fixed then (F,), and what share [%] of all
    frames each stage takes."""

    run: str
    us: NDArray[np.float64]
    contact: NDArray[np.bool_]
    shares: Mapping[str, float]


def traces(frames: int | None = None, repeats: int = REPEATS) -> tuple[Trace, ...]:
    """Both methods over all frames of the scene, or over the first `frames`."""
    found = []
    touches: NDArray[np.bool_] | None = None
    for preset in PRESETS:
        job = Job(SCENE, "avatarsim", preset, full=True, frames=frames)
        if touches is None:
            touches = contact(job)
        runs = [repeat(job, len(touches)) for _ in range(repeats)]
        around = np.array([times for times, _, _ in runs], dtype=np.int64)
        stages = {name: np.array([stage[name] for _, stage, _ in runs], dtype=np.int64) for name in runs[0][1]}
        timed = Timed(around, stages)
        shares = {name: 100.0 * float(spent.sum()) / float(timed.engine_ns.sum()) for name, spent in stages.items()}
        found.append(Trace(job.run, timed.best_us, touches, shares))
    return tuple(found)


def contact(job: Job) -> NDArray[np.bool_]:
    """(F,) whether the tracker's own hand overlaps a fixed body at the end of each frame, by the judge."""
    from reference.judging.judge import Judge

    scenario, scene, motion = job.asked()
    judge = Judge(scene)
    places = np.array([body.position for body in scene.bodies], dtype=np.float64)
    turns = np.array([body.orientation for body in scene.bodies], dtype=np.float64)
    found = np.zeros(scenario.frames, dtype=bool)
    for k in range(scenario.frames):
        position, orientation = link_poses(scene.avatars, motion(k))
        found[k] = judge.overlaps(np.concatenate([places, position]), np.concatenate([turns, orientation])).deepest > SEEN
    return found
