"""`python -m scenarios.drawn_crowds [--scenes N] [--seed S] [--engines ENGINE/PRESET ...] [--jobs N]`: crowds that nothing was
tuned for: random convex bodies poured, struck, swept, gripped, kicked and moved.

Crowd k is drawn with seed S + k, run, judged and measured: a line for each, then the worst figures and how many crowds are
outside the bounds. The bounds are put to the first engine; others are shown beside it. Crowd k alone: `--scenes 1 --seed S+k`.

Exit codes: 0; 1 a bound was broken; 2 wrong usage; 3 a crowd crashed or was not measured.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from avatarsim.console import ended
from avatarsim.errors import AvatarsimError, InvalidInput
from runfiles.naming import GATED
from scenarios.drawn_crowds import KINDS, seeds_of
from scenarios.job import Outcome
from scenarios.run.gate import FAILED, INCOMPLETE, PASSED, USAGE
from scenarios.run.harness import named_runs, outcomes
from scenarios.studies.broken import broken
from scenarios.studies.crowds import HEAD, in_columns, jobs, line, summary
from scenarios.unseen import seeds


def parser() -> argparse.ArgumentParser:
    """All options."""
    top = argparse.ArgumentParser(
        prog="python -m scenarios.drawn_crowds",
        description="Random convex bodies poured, struck, swept, gripped, kicked and moved.",
    )
    top.add_argument("--scenes", type=int, default=20, metavar="N", help="how many crowds (20)")
    top.add_argument("--seed", type=int, default=None, metavar="S", help="seed of the first (default: the commit's own)")
    top.add_argument("--kind", choices=[kind.__name__ for kind in KINDS], help="only crowds of this kind")
    top.add_argument("--engines", nargs="+", default=["/".join(GATED)], metavar="ENGINE/PRESET",
                     help="the first is put to the bounds, others are shown beside it")
    top.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs side by side")
    top.add_argument("--frames", type=int, default=None, metavar="N", help="only so many frames of each")
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run all crowds and return the exit code."""
    asked = parser().parse_args(arguments)
    try:
        for thing, value, least in (("--scenes", asked.scenes, 1), ("--jobs", asked.jobs, 1), ("--frames", asked.frames, 1),
                                    ("--seed", asked.seed, 0)):
            if value is not None and value < least:
                raise InvalidInput(thing, value, f"{least} at least")
        runs = named_runs("--engines", asked.engines)
    except AvatarsimError as error:
        print(f"scenarios.drawn_crowds: {error}", file=sys.stderr)
        return USAGE
    first = seeds.drawn().seed if asked.seed is None else asked.seed
    print(f"{asked.scenes} drawn crowds: --seed {first}" + (f" ({seeds.drawn().said})" if asked.seed is None else ""))
    print(in_columns(HEAD))
    found, troubles = list[Outcome](), list[str]()
    with tempfile.TemporaryDirectory() as folder:
        for outcome in outcomes(jobs(seeds_of(asked.kind, first, asked.scenes), runs, asked.frames), Path(folder), asked.jobs):
            if outcome.recording is not None:
                outcome.recording.unlink(missing_ok=True)
            if outcome.state == "measured":
                found.append(outcome)
                print(line(outcome), flush=True)
            else:
                troubles.append(f"{outcome.job.scenario} {outcome.job.run}: {outcome.state}: {outcome.note}")
                print(troubles[-1], flush=True)
    print(summary(sorted(found, key=lambda outcome: runs.index((outcome.job.engine, outcome.job.preset)))))
    for said in troubles:
        print(said)
    judged = [outcome for outcome in found if (outcome.job.engine, outcome.job.preset) == runs[0]]
    return FAILED if any(map(broken, judged)) else INCOMPLETE if troubles else PASSED


if __name__ == "__main__":
    sys.exit(ended(main))
