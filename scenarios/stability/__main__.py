"""`python -m scenarios.stability [--run FOLDER] [--kept FOLDER] [--engine NAME ...] [--filter GLOB,...] [--draws N] [--jobs N]`.

Tries every hard case under every change, in every engine, side by side; prints a table and writes stability.csv into the run's
folder. What is finished is kept beside all runs and not done again while no source changes: a command that was stopped goes on.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName
from avatarsim.running.processes import Workers
from avatarsim.running.stopping import stoppable
from runfiles.csv_rows import csv_text
from runfiles.files import OUT, last_comparison, write_text
from runfiles.naming import BASELINE
from scenarios.engines import known
from scenarios.results.gate import NOTHING
from scenarios.running.cluster import HELP, OPTION, workers_of
from scenarios.running.harness import offers
from scenarios.running.offered import filtered, unmatched
from scenarios.running.progress import Progress
from scenarios.stability.finished import NAME as FINISHED
from scenarios.stability.finished import Finished, stamp
from scenarios.stability.outcome import UNASKED, Outcome, Task
from scenarios.stability.plan import CASES, TOGETHER, trials
from scenarios.stability.rows import LONG, NAME, Row, rows, table
from scenarios.stability.side_by_side import answers

KEPT = OUT / "stability"
"""Folder of what is finished."""


def tasks_of(presets: dict[str, tuple[str, ...]], pattern: str, draws: int) -> list[Task]:
    """Every trial of every case whose name fits, by every engine and preset; the plain trials first."""
    cases = filtered(CASES, pattern)
    return [
        Task(case, seconds, engine, preset, trial) for trial in trials(draws) for case, seconds in cases.items()
        for engine, offered in presets.items() for preset in offered
    ]


def swept(tasks: Sequence[Task], folder: Path, workers: Workers) -> dict[Task, Outcome]:
    """Every task with its outcome, those that were finished earlier among them."""
    kept = Finished(folder / FINISHED, stamp())
    missing = kept.missing(tasks)
    with Progress("stability", len(missing), sys.stderr) as progress:
        for task, done in answers(missing, workers):
            kept.add(task, done)
            progress.step(f"{task.case} {task.run} {task.trial.kind} {task.trial.level} {done.state}")
    return {task: kept.of(task) for task in tasks}


def run_of(asked: Path | None) -> Path:
    """The folder asked for; else that of the last comparison, or, before the first one, where what is finished is kept."""
    return asked if asked is not None else last_comparison(OUT, KEPT.name)


def main(argv: Sequence[str] | None = None) -> int:
    """Try, print, write. 0: done; 2: usage; 3: an engine could not be asked or gave no answer; 5: the filter matched nothing;
    130: stopped."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.stability", description=str(__doc__).splitlines()[2])
    parser.add_argument("--run", type=path_option, metavar="FOLDER", help="folder for the rows (default: the last comparison)")
    parser.add_argument("--kept", type=path_option, default=KEPT, metavar="FOLDER", help="folder of what is finished")
    everybody = [name for name in known() if name != BASELINE]
    parser.add_argument("--engine", nargs="+", default=everybody, metavar="NAME", help="engines (default: all)")
    parser.add_argument("--filter", default="*", metavar="GLOB,...", help="cases (default: all)")
    parser.add_argument("--draws", type=int, default=TOGETHER, metavar="N", help=f"changes of all at once ({TOGETHER})")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="trials side by side; 0: here")
    parser.add_argument(OPTION, metavar="ADDRESS", help=HELP)
    asked = parser.parse_args(argv)
    try:
        if asked.draws < 0 or asked.jobs < 0:
            raise InvalidInput("--draws, --jobs", (asked.draws, asked.jobs), "0 at least")
        for name in asked.engine:
            if name not in known():
                raise UnknownName("engine", name, known())
        if wrong := unmatched(CASES, asked.filter):
            print(f"no case matches {' or '.join(map(repr, wrong))}; there are: {', '.join(CASES)}", file=sys.stderr)
            return NOTHING
        presets = {name: offer.presets for name, offer in offers(asked.engine, 1).items() if not offer.trouble}
        with stoppable():
            done = swept(tasks_of(presets, asked.filter, asked.draws), asked.kept, workers_of(asked))
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("stopped; what was finished is kept, and the same command goes on from there", file=sys.stderr)
        return 130
    found, path = rows(done, LONG), run_of(asked.run) / NAME
    write_text(path, csv_text(found, Row))
    print(table(found))
    print(f"\n{path}")
    silent = set(asked.engine) - set(presets)
    return 3 if silent or any(row.state in UNASKED[1:] for row in found) else 0


if __name__ == "__main__":
    sys.exit(ended(main))
