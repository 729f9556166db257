"""The whole benchmark: every cell and mode, all contenders in turns; then what it found, as files."""

import json
import math
import os
import platform
from collections.abc import Callable, Mapping
from collections.abc import Sequence as Many
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path

from reference.narrow_phase.cells import DEPTHS, DRIFT, GAPS, MODES, RATE, SEED, TURNING, Cell, Mode, Sequence, sequence
from reference.narrow_phase.clock import clocked
from reference.narrow_phase.contender import Contender, Identity
from reference.narrow_phase.field import contenders
from reference.narrow_phase.harness_cost import loop_cost
from reference.narrow_phase.rows import Row, csv_text, row
from reference.narrow_phase.truth import truths
from reference.narrow_phase.verdict import call_costs, judged

ROWS, VERDICTS, ABOUT = "narrow_phase.csv", "narrow_phase_cells.csv", "narrow_phase.json"
"""Files, beside those of the run: times and errors, verdicts, everything else."""

PACKAGES = ("numpy", "numba", "scipy", "coal", "python-fcl", "mujoco", "pybullet")


@dataclass(frozen=True)
class Plan:
    """How much is measured: pairs per cell; per mode frames, repeats, and every how many frames answers are judged."""

    pairs: int
    frames: Mapping[Mode, int]
    repeats: Mapping[Mode, int]
    judge_every: Mapping[Mode, int]


FULL = Plan(20, {"cold": 10, "coherent": 100}, {"cold": 9, "coherent": 5}, {"cold": 1, "coherent": 5})
"""200 cold and 2000 coherent queries per cell; 200 and 400 of them judged."""

QUICK = Plan(3, {"cold": 2, "coherent": 6}, {"cold": 1, "coherent": 1}, {"cold": 1, "coherent": 2})
"""For tests of the plumbing: its times mean nothing."""


SPHERES = Cell("sphere", "sphere", "apart")
CALLS = 5
"""Frames of sphere pairs per turn, from which the cost of a call is known where it is taken off."""


def callers(plan: Plan, mode: Mode, rooms: tuple[str, ...]) -> dict[str, tuple[Contender, Sequence]]:
    """By name, every contender that is called from Python for each query, loaded with pairs of spheres."""
    spheres = sequence(SPHERES, mode, plan.pairs, CALLS)
    found = {c.identity.name: (c, spheres) for c in contenders(rooms)[0] if c.identity.per_call}
    for contender, _ in found.values():
        contender.load_call(spheres, mode)
    return found


def measure(
    rooms: tuple[str, ...], cells: Many[Cell], plan: Plan, say: Callable[[str], None]
) -> tuple[list[Row], list[Identity], dict[str, str]]:
    """Rows of all cells and modes, which contenders took part, and why others did not; `say` hears of each cell."""
    taking_part, absent = contenders(rooms)
    calls = {mode: callers(plan, mode, rooms) for mode in MODES}
    rows = []
    for number, cell in enumerate(cells, start=1):
        for mode in MODES:
            asked = sequence(cell, mode, plan.pairs, plan.frames[mode])
            frames = range(0, asked.frames, plan.judge_every[mode])
            truth = truths(asked, frames)
            found = clocked(taking_part, asked, mode, plan.repeats[mode], frames, calls[mode])
            rows += [row(cell, mode, c.identity, found[c.identity.name], truth) for c in taking_part]
        say(f"narrow phase {number}/{len(cells)}  {cell.name}")
    return rows, [contender.identity for contender in taking_part], absent


def about(
    plan: Plan, rows: Many[Row], identities: Many[Identity], absent: Mapping[str, str], seconds: float
) -> dict[str, object]:
    """Everything that is no table: what was run, where, with which settings and reasons, and what a call costs."""
    clock, loop = loop_cost(plan.pairs)
    return {
        "plan": asdict(plan),
        "motion": {
            "seed": SEED, "frame_s": RATE, "turning_rad_s": TURNING, "drift_rad_s": DRIFT, "gaps_m": GAPS, "depths": DEPTHS,
        },
        "engines": [asdict(identity) for identity in identities],
        "absent": dict(absent),
        "call_us": [{"engine": name, "mode": mode, "us": us} for (name, mode), us in call_costs(rows).items()],
        "harness_us": {"clock": clock, "clock_and_loop": loop},
        "start_up": None,
        "provenance": {
            "ended": datetime.now(UTC).isoformat(timespec="seconds"), "seconds": round(seconds, 1),
            "python": platform.python_version(), "platform": platform.platform(), "cpus": os.cpu_count() or 1,
            "load": list(os.getloadavg()) if hasattr(os, "getloadavg") else [],
            "versions": {name: _version(name) for name in PACKAGES},
        },
    }


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def write(folder: Path, rows: Many[Row], said: Mapping[str, object]) -> None:
    """The three files, each whole or not at all."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        ROWS: csv_text(rows), VERDICTS: csv_text(judged(rows)),
        ABOUT: json.dumps(_plain(said), allow_nan=False, indent=1, ensure_ascii=False) + "\n",
    }
    for name, text in texts.items():
        beside = folder / f".{name}.{os.getpid()}"
        beside.write_text(text, encoding="utf-8")
        os.replace(beside, folder / name)


def _plain(value: object) -> object:
    """Numbers that JSON has no word for become None."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
