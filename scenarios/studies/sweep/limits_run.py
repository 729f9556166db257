"""The runs behind convergence.csv: which are known, the others side by side, and the rows of every scene."""

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from avatarsim.running.processes import Died
from scenarios import catalog
from scenarios.job import Job
from scenarios.results.fingerprint import find, key_of, sources
from scenarios.results.store import Entry, Store
from scenarios.running.processes import side_by_side
from scenarios.running.progress import Estimate
from scenarios.studies.sweep import limit
from scenarios.studies.sweep.limit import FINEST, RATES, Array, Row

KIND = "limit"
"""Kind of the entries in the store; the poses lie beside them."""


def key(job: Job) -> str:
    """What a run hangs on."""
    return f"{key_of(job)}-{sources([find(limit.__name__)])[:8]}"


def poses_at(store: Store, name: str) -> Path:
    """Where the poses of a run lie."""
    return store.folder / f"{name}.{KIND}.npy"


def _ran(job: Job, store: Store, keys: dict[str, str]) -> Entry:
    return limit.ran(job, poses_at(store, keys[job.stem]))


def converge(
    scenes: Sequence[str], presets: dict[str, tuple[str, ...]], store: Store, workers: int, full: bool, frames: int | None
) -> list[Row]:
    """The rows of all scenes, engines, presets and steps; each run is kept as soon as it has ended."""
    asked = {
        (scene, engine, preset, rate): limit.job_of(scene, engine, preset, rate, full, frames)
        for scene in scenes for engine, offered in presets.items() for preset in offered for rate in (*RATES, FINEST)
    }
    keys = {job.stem: key(job) for job in asked.values()}
    entries = {
        job.stem: found for job in asked.values()
        if (found := store.get(KIND, keys[job.stem])) is not None and _whole(poses_at(store, keys[job.stem]))
    }
    # the longest first: begun last, one of them would keep a single processor busy while the others have nothing left to do
    finest_first = sorted(asked, key=lambda wish: -wish[-1])
    todo = [asked[wish] for wish in finest_first if asked[wish].stem not in entries]
    said = Estimate("convergence", len(todo), sys.stderr)
    for job, answer in side_by_side(partial(_ran, store=store, keys=keys), todo, workers):
        died = {"run": job.run, "note": str(answer), "overlap": None, "beyond": None}
        entries[job.stem] = died if isinstance(answer, Died) else answer
        if not isinstance(answer, Died):
            store.put(KIND, keys[job.stem], answer)
        said.step(f"{job.scenario} {job.run}")
    rows: list[Row] = []
    for scene in scenes:
        known = {
            (engine, preset, rate): (entries[job.stem], _poses(poses_at(store, keys[job.stem])))
            for (name, engine, preset, rate), job in asked.items() if name == scene
        }
        rows += limit.rows(scene, catalog.get(scene).as_run(full).build(), known)
    return rows


def _whole(path: Path) -> bool:
    """Whether the poses of a run can be read, or there are none."""
    try:
        _poses(path)
    except (EOFError, OSError, ValueError):
        return False
    return True


def _poses(path: Path) -> Array | None:
    if not path.exists():
        return None
    found: Array = np.load(path)
    return found


def table(rows: Sequence[Row]) -> str:
    """A line per scene, engine and preset: distances from the own finest run by step, their order, and what that run is like."""
    lines = []
    for scene in dict.fromkeys(row.scenario for row in rows):
        head = "".join(f"{f'1/{rate}':>9}" for rate in RATES)
        lines.append(f"{scene}, mm from the own run at 1/{FINEST}")
        lines.append(f"  {'':28}{head}   order; there: overlap mm, beyond deg, mm from ours")
        for engine, preset in dict.fromkeys((row.engine, row.preset) for row in rows if row.scenario == scene):
            own = {row.rate: row for row in rows if (row.scenario, row.engine, row.preset) == (scene, engine, preset)}
            cells = "".join(f"{1e3 * own[rate].off:9.3g}" for rate in RATES)
            end = own[FINEST]
            there = f"{1e3 * end.overlap:.3g}, {end.beyond:.3g}, {1e3 * end.from_ours:.3g}"
            power = limit.order(list(own.values()))
            lines.append(f"  {f'{engine}/{preset}':28}{cells}   {power:5.2f}; {there}  {end.note}".rstrip())
    return "\n".join(lines)
