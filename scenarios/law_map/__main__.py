"""`python -m scenarios.law_map [--run FOLDER] [--engine NAME ...] [--law NAME ...] [--shape NAME ...] [--quick] [--jobs N]`.

Measures what becomes of restitution and friction, prints a table and writes law_map.csv into the run's folder. What was found
before is kept below reports/out/sweep and not asked again.
"""

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError, UnknownName
from avatarsim.running.processes import Died
from avatarsim.running.stopping import stoppable
from runfiles.csv_rows import csv_text
from runfiles.files import OUT, last_comparison, write_text
from runfiles.naming import BASELINE
from scenarios.engines import known
from scenarios.job import Job
from scenarios.law_map import worlds
from scenarios.law_map.asking import job_of, obtained, without_figures
from scenarios.law_map.rows import Row, table
from scenarios.results.fingerprint import find, key_of, sources
from scenarios.results.gate import STOPPED
from scenarios.results.store import Store
from scenarios.running.harness import offers
from scenarios.running.processes import side_by_side
from scenarios.running.progress import Estimate

DIGITS = 9
"""Significant digits of a figure: the closest of these are told apart by them."""
NAME, KIND = "law_map.csv", "law"
"""The file of rows, and the kind of its entries in the store."""
GATED = ("avatarsim",)
"""Engines of which one preset is asked: the methods of ours share one law of contact."""


def jobs_of(asked: argparse.Namespace, presets: dict[str, tuple[str, ...]]) -> list[Job]:
    """Every engine and preset with every law, shape and step that is asked for."""
    rates = worlds.RATES[:2] if asked.quick else worlds.RATES
    return [
        job_of(law, shape, rate, engine, preset) for law in asked.law for shape in asked.shape
        for engine, offered in presets.items() for preset in (offered[:1] if engine in GATED else offered) for rate in rates
    ]


def measured(jobs: Sequence[Job], store: Store, workers: int) -> list[Row]:
    """The rows of all jobs, in their order; found ones are kept at once, known ones are not asked again."""
    method = sources([find("scenarios.law_map.asking")])
    keys = {job.scenario + job.run: f"{key_of(job)}-{method[:8]}" for job in jobs}
    known_rows = {name: [kept(row) for row in found["rows"]] for name, key in keys.items() if (found := store.get(KIND, key))}
    todo = [job for job in jobs if job.scenario + job.run not in known_rows]
    said = Estimate("law map", len(todo), sys.stderr)
    for job, answer in side_by_side(obtained, todo, workers):
        name = job.scenario + job.run
        if isinstance(answer, Died):
            known_rows[name] = without_figures(job, str(answer))
        else:
            known_rows[name] = answer
            store.put(KIND, keys[name], {"rows": [asdict(row) for row in answer]})
        said.step(f"{job.scenario} {job.run}")
    return [row for job in jobs for row in known_rows[job.scenario + job.run]]


def kept(row: Mapping[str, Any]) -> Row:
    """A row as it was put into the store, where numbers that are none are words."""
    numbers = {name: float(row[name]) for name in ("asked", "got", "low", "high")}
    return Row(**{**row, **numbers})


def main(argv: Sequence[str] | None = None) -> int:
    """Measure, print, write. 0: done; 2: usage; 3: an engine gave no figures; 130: stopped."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.law_map", description=str(__doc__).splitlines()[2])
    beside = last_comparison(OUT, "sweep")
    parser.add_argument("--run", type=path_option, default=beside, metavar="FOLDER", help="folder for the file")
    everybody = [name for name in known() if name != BASELINE]
    parser.add_argument("--engine", nargs="+", default=everybody, metavar="NAME", help="engines (default: all)")
    parser.add_argument("--law", nargs="+", default=worlds.LAWS, choices=worlds.LAWS, metavar="NAME")
    parser.add_argument("--shape", nargs="+", default=worlds.SHAPES, choices=worlds.SHAPES, metavar="NAME")
    parser.add_argument("--quick", action="store_true", help="the coarse steps only: shows that it runs")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs side by side; 0: here")
    asked = parser.parse_args(argv)
    try:
        for name in asked.engine:
            if name not in known():
                raise UnknownName("engine", name, known())
        offered = offers(asked.engine, 1)
        presets = {name: offered[name].presets for name in asked.engine if not offered[name].trouble}
        with stoppable():
            rows = measured(jobs_of(asked, presets), Store(asked.run.absolute().parent / "sweep" / "found"), asked.jobs)
        asked.run.mkdir(parents=True, exist_ok=True)
        write_text(asked.run / NAME, csv_text(rows, Row, DIGITS))
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("stopped; what was finished is kept, and the same command goes on from there", file=sys.stderr)
        return STOPPED
    print(table(rows))
    print(f"\n{asked.run / NAME}")
    return 3 if len(presets) < len(asked.engine) else 0


if __name__ == "__main__":
    sys.exit(ended(main))
