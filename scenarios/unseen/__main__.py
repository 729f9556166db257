"""`python -m scenarios.unseen [--motions N] [--seed S] [--jobs N]`: our engine on many motions that nothing was tuned for.

Motion k is drawn with seed S + k, once in each of the five rooms, run, judged and measured. Printed per room: the promises
(overlap, limits), and how it looks (chatter, reversals, dashes, silence, slowest frame), which has no bound. Every broken promise
is named with its seed: `python -m scenarios run NAME --seed N` runs it again.

Exit codes: 0; 1 a promise was broken; 2 wrong usage; 3 a motion crashed or was not measured.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from avatarsim.console import ended
from avatarsim.errors import AvatarsimError, InvalidInput
from avatarsim.running.processes import Died
from scenarios.run.gate import FAILED, INCOMPLETE, PASSED, USAGE
from scenarios.run.processes import side_by_side
from scenarios.run.progress import Progress
from scenarios.studies.broken import broken
from scenarios.studies.unseen_motions import Seen, jobs, seen, table
from scenarios.unseen import seeds


def parser() -> argparse.ArgumentParser:
    """All options."""
    top = argparse.ArgumentParser(prog="python -m scenarios.unseen", description=str(__doc__).split(": ", 1)[1].splitlines()[0])
    top.add_argument("--motions", type=int, default=20, metavar="N", help="motions in each room")
    top.add_argument("--seed", type=int, default=None, metavar="S", help="seed of the first (default: the commit's own)")
    top.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs side by side")
    top.add_argument("--frames", type=int, default=None, metavar="N", help="only so many frames of each")
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run all motions and return the exit code."""
    asked = parser().parse_args(arguments)
    try:
        for thing, value in (("--motions", asked.motions), ("--jobs", asked.jobs), ("--frames", asked.frames)):
            if value is not None and value < 1:
                raise InvalidInput(thing, value, "1 at least")
        if asked.seed is not None and asked.seed < 0:
            raise InvalidInput("--seed", asked.seed, "0 at least")
    except AvatarsimError as error:
        print(f"scenarios.unseen: {error}", file=sys.stderr)
        return USAGE
    origin = seeds.drawn()
    first = origin.seed if asked.seed is None else asked.seed
    print(origin.said if asked.seed is None else f"seed {first} of the unseen motions, as asked for")
    rows, troubles = list[Seen](), list[str]()
    todo = jobs(asked.motions, first, asked.frames)
    with tempfile.TemporaryDirectory() as folder, Progress("unseen", len(todo), sys.stderr) as progress:
        for job, answer in side_by_side(partial(seen, folder=Path(folder)), todo, asked.jobs, lambda job: True):
            if isinstance(answer, Died):
                troubles.append(f"{job.scenario} --seed {job.seed}: {answer}")
            elif answer.outcome.state != "measured":
                troubles.append(f"{job.scenario} --seed {job.seed}: {answer.outcome.state}: {answer.outcome.note}")
            else:
                rows.append(answer)
            progress.step(f"{job.scenario} {job.seed}")
    promises = [said for row in rows for said in broken(row.outcome).values()]
    print(table(rows))
    for said in (*promises, *troubles):
        print(said)
    return FAILED if promises else INCOMPLETE if troubles else PASSED


if __name__ == "__main__":
    sys.exit(ended(main))
