"""Frame time against the number of links of one avatar, of avatars, and of objects, in every engine."""

import argparse
import sys
from dataclasses import dataclass
from math import nan
from pathlib import Path

import numpy as np

from avatarsim.errors import UnknownName
from benchmarks import growth_scenes as scenes
from benchmarks.output import print_pivot, write_rows
from runfiles.naming import BASELINE
from scenarios.engines import known
from scenarios.job import Job
from scenarios.run.harness import offers
from scenarios.run.timing import Clocked, timed_pass

BEST = {"mujoco": ("tuned",), "pybullet": ("tuned",)}
"""Presets timed of the engines we compare with: their best for contact. Of all others every one."""
MAX_SIZES = {
    ("mujoco", "avatars"): 10, ("pybullet", "avatars"): 10, ("pybullet", "links"): 100,
    ("mujoco", "objects"): 200, ("pybullet", "objects"): 200,
}
"""Largest size of an engine: more avatars, or objects that do not sleep, take these minutes, and PyBullet has no room for the
joints of 199 links."""


@dataclass(frozen=True)
class Row:
    """Frame time [us], median and 95th percentile of each frame's least over the repeats, of a scene with `size` links
    (avatars, objects), `links` in all; nan with the reason in `note` where nothing was timed. `power`: of the size, with which
    p50 grew from the next smaller size."""

    grows: str
    mode: str
    size: int
    links: int
    run: str
    p50: float = nan
    p95: float = nan
    power: float = nan
    note: str = ""


def jobs_of(kind: str, size: int, mode: str, engines: dict[str, tuple[str, ...]]) -> list[Job]:
    """Return every engine and preset that takes part in a scene; objects also with the other engines' own sleeping."""
    name = f"{kind}_{size}_{mode}"
    jobs = [
        Job(name, engine, preset, full=True, catalogue=scenes.__name__) for engine, presets in engines.items()
        for preset in presets if size <= MAX_SIZES.get((engine, kind), size)
    ]
    asleep = [
        Job(name, engine, "sleeping", full=True, base=presets[0], options={"sleep": True}, catalogue=scenes.__name__)
        for engine, presets in engines.items() if engine in BEST and kind == "objects"
    ]
    return [*jobs, *asleep]


def row(kind: str, mode: str, size: int, clocked: Clocked, smaller: Row | None) -> Row:
    """Return the times of one engine."""
    head = (kind, mode, size, len(scenes.get(clocked.job.scenario).build().links), clocked.job.run)
    if clocked.timed is None:
        return Row(*head, note=clocked.note)
    p50, p95 = np.percentile(clocked.timed.best_us, (50, 95)).tolist()
    power = float(np.log(p50 / smaller.p50) / np.log(size / smaller.size)) if smaller else nan
    return Row(*head, p50, p95, power, clocked.note)


def run(arguments: argparse.Namespace, folder: Path) -> int:
    """Time, write, print. 3: an engine gave no times. Raises UnknownName for an engine that is not known."""
    names = arguments.engine or [name for name in known() if name != BASELINE]
    for name in names:
        if name not in known():
            raise UnknownName("engine", name, known())
    offered = offers(names, 1)
    engines = {name: BEST.get(name, offered[name].presets) for name in names if not offered[name].trouble}
    rows: list[Row] = []
    for kind, sizes in scenes.SIZES.items():
        for mode in scenes.MODES[kind]:
            smaller: dict[str, Row] = {}
            for size in sizes[:1] if arguments.quick else sizes:
                # an engine that takes long gets fewer repeats
                size_rows = [row(kind, mode, size, one, smaller.get(one.job.run))
                         for one in timed_pass(jobs_of(kind, size, mode, engines), False)]
                smaller = {one.run: one for one in size_rows}
                rows += size_rows
                print(f"growth  {kind} {size}, {mode}", file=sys.stderr, flush=True)
    for kind in scenes.SIZES:
        here = [row for row in rows if row.grows == kind]
        print_pivot(f"us per frame against {kind} (median)", here, ("mode", "run"), "size", "p50")
    write_rows(folder / "growth.csv", rows, Row)
    return 3 if any(row.p50 != row.p50 for row in rows) else 0
