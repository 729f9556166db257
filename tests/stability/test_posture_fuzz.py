"""Hostile fuzz of the checked posture, judged by poses alone. Longer by hand: python -m tests.stability.test_posture_fuzz."""

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass, field

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine
from reference.judge import Judge
from tests.stability.hostile import DT, TRIALS, ball_excess, hinge_excess, hostile_motion, link_error, outside_room

ARRIVED = 0.01
"""[m] rms distance of link origins from the tracker's below which an avatar is home."""
PATIENCE = 90
"""Frames (1.5 s) after which an avatar that is not home although home is free counts as stuck."""
ROUNDING = 1e-9
"""[rad] excess of a ball that the detour over quaternions may show: orientations are exported, not swings."""


@dataclass
class Report:
    """What a run found; every list holds (frame, kind of motion, value)."""

    frames: int = 0
    overlaps: list[tuple[int, str, object]] = field(default_factory=list)
    outside: list[tuple[int, str, float]] = field(default_factory=list)
    hinges: list[tuple[int, str, float]] = field(default_factory=list)
    balls: list[tuple[int, str, float]] = field(default_factory=list)
    not_finite: list[tuple[int, str, float]] = field(default_factory=list)
    returns: int = 0
    late: int = 0
    stuck: list[tuple[int, str, float]] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    closest: float = np.inf
    hashes: list[str] = field(default_factory=list)
    micros: list[float] = field(default_factory=list)


def run(name: str, seed: int, frames: int, away: int = 60, home: int = 90, judge_every: int = 1, **options: object) -> Report:
    """Drive avatar `name` through hostile motion for `frames` frames; the judge sees every `judge_every`-th."""
    at = TRIALS[name]()
    engine, judge, report = AvatarsimEngine(), Judge(at.scene), Report()
    engine.load(at.scene, Settings(options=options, seed=seed), DT)
    before, kind_before, waited = "home", "home", 0
    arrived = True
    for frame, (kind, sample) in enumerate(hostile_motion(at, seed, away, home)):
        if frame == frames:
            break
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
            (report.balls, ball_excess(at.scene, record), ROUNDING),
        ):
            if not value <= most:
                found.append((frame, kind, value))
        if kind == "home":
            if before != "home":
                report.returns, arrived, waited, kind_before = report.returns + 1, False, 0, before
            if not arrived:
                waited += 1
                error = link_error(at.scene, record, sample)
                arrived = error < ARRIVED
                report.late += waited == PATIENCE // 3 and not arrived
                if waited == PATIENCE and not arrived:
                    report.stuck.append((frame, kind_before, error))
        before = kind
    return report


@pytest.mark.parametrize("name", TRIALS)
def test_hostile_motion_never_overlaps_leaves_the_room_or_breaks_a_limit(name: str) -> None:
    """A short slice of what the command line runs for long."""
    report = run(name, seed=3, frames=300, away=30, home=30)
    assert report.frames == 300
    assert report.overlaps == []
    assert report.outside == []
    assert report.hinges == []
    assert report.balls == []
    assert report.not_finite == []
    # the motion was hostile enough to mean something
    assert report.counts["rows"] > 100 and report.closest < 1e-3


def test_same_seed_same_bits() -> None:
    """Two runs in one process end in the same states, frame by frame."""
    first, second = (run("hinged", seed=5, frames=60, away=20, home=10, judge_every=1000) for _ in range(2))
    assert first.hashes == second.hashes
    assert len(set(first.hashes)) > 20


def main() -> int:
    """Long runs by hand; 1 if something overlapped, got out, passed a limit or was not finite."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--avatar", choices=sorted(TRIALS), default="hinged")
    parser.add_argument("--frames", type=int, default=3000)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    parser.add_argument("--judge-every", type=int, default=1)
    chosen, broken = parser.parse_args(), 0
    for seed in chosen.seeds:
        r = run(chosen.avatar, seed, chosen.frames, judge_every=chosen.judge_every)
        p50, p99 = np.percentile(r.micros[5:], [50, 99])
        excess = f"{len(r.hinges)} hinge excess, {len(r.balls)} ball excess, {len(r.not_finite)} not finite"
        print(f"{chosen.avatar} seed {seed}: {r.frames} frames, {len(r.overlaps)} overlaps, {len(r.outside)} outside, {excess},")
        print(f"    {r.returns} returns, {r.late} late, {len(r.stuck)} stuck, gap {r.closest:.3g} m, {p50:.0f} / {p99:.0f} us")
        for title in ("overlaps", "outside", "hinges", "balls", "not_finite", "stuck"):
            for found in getattr(r, title)[:5]:
                print("   ", title, found)
        print("   ", dict(r.counts))
        broken += len(r.overlaps) + len(r.outside) + len(r.hinges) + len(r.balls) + len(r.not_finite)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
