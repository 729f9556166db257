"""Drives an avatar through hostile motion, and writes down the judge's findings and how long each return takes."""

import time
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice

import numpy as np

from avatarsim.engine import Settings
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from reference.judging.judge import Judge
from tests.progress_bar import told
from tests.stability.hostile import (
    DT,
    TRIALS,
    Trial,
    ball_excess,
    hinge_excess,
    hostile_motion,
    link_error,
    one_return,
    outside_room,
)

ARRIVED = 0.01
"""[m] rms distance of link origins from the tracker's below which an avatar is home."""
PROMPT = 30
"""Frames (0.5 s) within which SOON of the returns shall end."""
SOON = 0.75
"""Joints catch up with 12.5 rad/s and roots with 5 m/s: of 667 and 500 returns of each avatar 15 to 22 % took longer, most of two
avatars, which also meet each other."""
PATIENCE = 90
"""Frames (1.5 s) within which AT_LAST of the returns end; of the others frame records report that the avatar waits or is led."""
AT_LAST = 0.98
"""Of the same returns 0.2 to 0.9 % took longer."""
SAID = ("waiting", "planning", "following")
"""Statuses that report it."""
ROUNDING = 1e-9
"""[rad] excess of a ball that the detour over quaternions may show: orientations are exported, not swings."""
AT_ONCE = 1000
"""Frames whose balls are looked at together."""
RETURN_SEEDS = range(1, 501)
"""The stated list of 500 hostile returns, each from home by one stretch of motion and home again."""


@dataclass
class Return:
    """One return: where it was, after which kind of motion, frames until home (None: not within PATIENCE), whether one of SAID
    was reported."""

    where: int
    kind: str
    frames: int | None = None
    is_said: bool = False


@dataclass
class Report:
    """Findings of a run; every list but `returns` holds (frame, kind of motion, value)."""

    frames: int = 0
    overlaps: list[tuple[int, str, object]] = field(default_factory=list)
    outside: list[tuple[int, str, float]] = field(default_factory=list)
    hinges: list[tuple[int, str, float]] = field(default_factory=list)
    balls: list[tuple[int, str, float]] = field(default_factory=list)
    not_finite: list[tuple[int, str, float]] = field(default_factory=list)
    returns: list[Return] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    closest: float = np.inf
    hashes: list[str] = field(default_factory=list)
    micros: list[float] = field(default_factory=list)

    def home_within(self, frames: int) -> float:
        """Return the share of the returns that ended within so many frames."""
        return sum(r.frames is not None and r.frames <= frames for r in self.returns) / max(1, len(self.returns))

    def silent(self) -> list[Return]:
        """Return those that did not end within PATIENCE, and of which no frame record gives a status."""
        return [r for r in self.returns if r.frames is None and not r.is_said]

    def broken(self) -> int:
        """Return the number of events that never may happen."""
        lists = (self.overlaps, self.outside, self.hinges, self.balls, self.not_finite, self.silent())
        return sum(len(found) for found in lists)


def drive(
    at: Trial, motion: Iterable[tuple[str, TrackerSample]], judge: Judge, settings: Settings, judge_every: int, report: Report,
    where: int | None = None,
) -> None:
    """One engine through one motion; the judge sees every `judge_every`-th frame. `where` names the returns, else their frame."""
    engine, before, now, shown = AvatarsimEngine(), "home", None, list[tuple[str, np.ndarray]]()
    engine.load(at.scene, settings, DT)
    for frame, (kind, sample) in enumerate(motion):
        start = time.perf_counter_ns()
        record = engine.advance(sample, DT)
        report.micros.append(1e-3 * (time.perf_counter_ns() - start))
        report.frames += 1
        report.counts.update({key: value for key, value in record.counts.items() if value})
        report.hashes.append(record.state_hash())
        if not np.isfinite(record.shown.positions).all() or not np.isfinite(record.shown.orientations).all():
            report.not_finite.append((frame, kind, np.nan))
        if frame % judge_every == 0:
            verdict = judge.overlaps(record.shown.positions, record.shown.orientations, 1e-3)
            report.closest = min(report.closest, verdict.gap)
            if not verdict.deepest == 0.0:
                report.overlaps.append((frame, kind, verdict.pairs or verdict.faults))
        for found, value, most in (
            (report.outside, outside_room(at.scene, record), 0.0),
            (report.hinges, hinge_excess(at.scene, record), 0.0),
        ):
            if not value <= most:
                found.append((frame, kind, value))
        if kind == "home" and before != "home":
            now, begun = Return(frame if where is None else where, before), frame
        if kind == "home" and now is not None:
            now.is_said = now.is_said or any(record.statuses.get(name, 0) > 0 for name in SAID)
            waited = frame - begun + 1
            if link_error(at.scene, record, sample) < ARRIVED:
                now.frames = waited
            if now.frames is not None or waited == PATIENCE:
                report.returns.append(now)
                now = None
        before = kind
        shown.append((kind, record.shown.orientations))
    for start in range(0, len(shown), AT_ONCE):
        some = shown[start : start + AT_ONCE]
        excess = ball_excess(at.scene, np.array([turns for _, turns in some]))
        report.balls += [(start + int(k), some[k][0], float(excess[k])) for k in np.flatnonzero(~(excess <= ROUNDING))]


ASKED: dict[str, dict[str, object]] = {"two": {"around": 2}}
"""Options of a trial. A palm without joints comes home round a table only with this option: else it lies on it, or under
it, and waits."""


def asked(name: str, seed: int, options: Mapping[str, object]) -> Settings:
    """Return settings of a run of avatar `name`."""
    return Settings(options={**ASKED.get(name, {}), **options}, seed=seed)


def run(
    name: str, seed: int, frames: int, away: int = 60, home: int = 90, judge_every: int = 1, aloud: bool = False,
    **options: object,
) -> Report:
    """Drive avatar `name` through hostile motion of every kind in turn for `frames` frames; `aloud` shows a bar."""
    at, report = TRIALS[name](), Report()
    motion: Iterable[tuple[str, TrackerSample]] = islice(hostile_motion(at, seed, away, home), frames)
    if aloud:
        motion = told(motion, frames, "frame")
    drive(at, motion, Judge(at.scene), asked(name, seed, options), judge_every, report)
    return report


def run_returns(name: str, seeds: Sequence[int], judge_every: int = 1, aloud: bool = False, **options: object) -> Report:
    """Run one hostile return of avatar `name` for each seed, each from the beginning; `aloud` shows a bar."""
    at, report = TRIALS[name](), Report()
    judge = Judge(at.scene)
    for seed in told(seeds, len(seeds), "return") if aloud else seeds:
        drive(at, one_return(at, seed, 60, PATIENCE), judge, asked(name, seed, options), judge_every, report, seed)
    return report
