"""`python -m tests.hostile.batch DOOR SEED COUNT [--first K] [--last K] [--out FILE]`: cases of one door, in this process,
which has limits.

What is found goes to FILE, or to the terminal, a line of JSON each, and at the end how many cases there were. Before each case
its number and text go to FILE.now, so that a crash or a hang is known by its case.
"""

import argparse
import json
import os
import sys
import tempfile
import warnings
from pathlib import Path
from typing import IO

LONGEST_TEXT = 400
"""Characters that are kept of a case's description."""


def parser() -> argparse.ArgumentParser:
    """The options; those after the first three are what repeats one case of a batch."""
    options = argparse.ArgumentParser(prog="python -m tests.hostile.batch", description="Hostile inputs for one door.")
    options.add_argument("door")
    options.add_argument("seed", type=int)
    options.add_argument("count", type=int, help="cases that are made")
    options.add_argument("--first", type=int, default=0, metavar="K", help="first case that is asked")
    options.add_argument("--last", type=int, metavar="K", help="last case that is asked")
    options.add_argument("--out", type=Path, metavar="FILE", help="where findings go (default: the terminal)")
    return options


def main(words: list[str] | None = None) -> int:
    """Make the cases of a seed and ask those that are wanted; 0 once all were asked, whatever they answered."""
    wanted = parser().parse_args(words)
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    # what numpy says of overflow on a hostile number is no answer; what it leads to is judged
    warnings.simplefilter("ignore")
    if wanted.out is None:
        ask(wanted, sys.stdout, os.open(os.devnull, os.O_WRONLY))
        return 0
    now = os.open(f"{wanted.out}.now", os.O_CREAT | os.O_WRONLY | os.O_TRUNC, 0o644)
    with wanted.out.open("a", encoding="utf-8") as found:
        ask(wanted, found, now)
    return 0


def ask(wanted: argparse.Namespace, found: IO[str], now: int) -> None:
    """Ask the wanted cases, one after the other."""
    from tests.hostile.every import door_named
    from tests.hostile.judged import Judge

    door, asked = door_named(wanted.door), 0
    with tempfile.TemporaryDirectory(prefix="hostile-") as folder:
        door.warm()
        judge: Judge | None = None
        for k, case in enumerate(door.cases(wanted.seed, wanted.count, Path(folder))):
            if k < wanted.first or (wanted.last is not None and k > wanted.last):
                continue
            # once the valid files have been made, and what makes them is imported
            judge = judge or Judge(door.reserves)
            text = case.text[:LONGEST_TEXT]
            os.pwrite(now, f"{k} {text}".encode("utf-8", "backslashreplace").ljust(4 * LONGEST_TEXT), 0)
            asked += 1
            wrong = judge.verdict(case)
            if wrong is not None:
                print(json.dumps({"case": k, "text": text, **vars(wrong)}), file=found, flush=True)
    print(json.dumps({"asked": asked}), file=found, flush=True)


if __name__ == "__main__":
    sys.exit(main())
