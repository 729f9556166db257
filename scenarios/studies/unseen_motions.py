"""Our engine on many unseen motions: run, judged, measured and timed one by one, and told room by room."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runfiles.naming import GATED
from scenarios import unseen
from scenarios.job import Job, Outcome
from scenarios.run.accuracy import accuracy
from scenarios.run.timed_worker import repeat
from scenarios.studies.broken import figure
from scenarios.unseen.rooms import ROOMS

HEAD = (
    "room", "motions", "overlap m", "limits deg", "chatter %", "reversal p95 mm", "own m/s^2", "dashes", "silent frames",
    "slowest us",
)


@dataclass(frozen=True)
class Seen:
    """What came of one motion, and the slowest of its frames [us], timed apart from the recording."""

    outcome: Outcome
    slowest: float


def seen(job: Job, folder: Path) -> Seen:
    """Run, judge and measure one motion; its recording is not kept. Then its frames once more, timed."""
    outcome = accuracy(job, folder)
    if outcome.recording is not None:
        outcome.recording.unlink(missing_ok=True)
    if outcome.state != "measured":
        return Seen(outcome, math.nan)
    around, _, _ = repeat(job, outcome.frames)
    return Seen(outcome, max(around) / 1e3)


def line(room: str, rows: Sequence[Seen]) -> tuple[str, ...]:
    """The cells of one room: worst of the promises, mean chatter, medians and sums of how it looks; nan where
    a motion has no figure."""
    def of(metric: str) -> np.ndarray:
        return np.array([figure(row.outcome, metric) for row in rows])

    limits = np.maximum(of("joint_limit_excess_max"), of("reach_cone_excess_max"))
    return (
        room, f"{len(rows)}", f"{of('residual_overlap_max').max():.2g}", f"{limits.max():.2g}",
        f"{np.mean(of('chatter_frames')):.2f}", f"{1e3 * np.median(of('reversal_p95')):.2f}",
        f"{np.median(of('own_acceleration_rms')):.2f}", f"{of('dash_frames').sum():.0f}",
        f"{of('silent_offset_frames').sum():.0f}", f"{max(row.slowest for row in rows):.0f}",
    )


def table(rows: Iterable[Seen]) -> str:
    """One line per room that was measured."""
    by_room: dict[str, list[Seen]] = {}
    for row in rows:
        by_room.setdefault(row.outcome.job.scenario, []).append(row)
    cells = [HEAD, *(line(room, found) for room, found in by_room.items())]
    return aligned(cells)


def aligned(cells: Sequence[Sequence[str]]) -> str:
    """Return rows of cells as text in columns, the first of which begins at the left."""
    widths = [max(len(row[k]) for row in cells) for k in range(len(cells[0]))]
    return "\n".join("  ".join(text.rjust(width) if k else text.ljust(width) for k, (text, width) in
                               enumerate(zip(row, widths, strict=True))) for row in cells)


def jobs(motions: int, first: int, frames: int | None = None) -> list[Job]:
    """Every motion in every room, at one rate of frames."""
    engine, preset = GATED
    return [Job(room, engine, preset, first + k, frames=frames, catalogue=unseen.NAME)
            for k in range(motions) for room in (room.scenario().name for room in ROOMS)]
