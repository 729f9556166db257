"""`python -m tests.hostile [--cases N] [--seed S] [--only GLOB] [--jobs N]`: hostile inputs for every reader, every public
constructor and the command lines.

Cases come in batches, each in a process of its own with limits of time and memory. Every outcome must be a valid result or a
typed error; all else is printed once per place with the command that repeats it, and the exit code is then 1.
"""

import argparse
import sys

from tests.hostile.campaign import Batch, ask, batches, campaign, doors


def parser() -> argparse.ArgumentParser:
    """Return the options."""
    options = argparse.ArgumentParser(prog="python -m tests.hostile", description=(__doc__ or "").split("\n\n")[1])
    options.add_argument("--cases", type=int, default=100_000, metavar="N", help="cases of all doors together (default 100000)")
    options.add_argument("--seed", type=int, default=1, metavar="S", help="equal seeds, equal cases (default 1)")
    options.add_argument("--only", default="*", metavar="GLOB", help="doors by name: " + ", ".join(doors()))
    options.add_argument("--jobs", type=int, default=2, metavar="N", help="batches side by side (default 2)")
    options.add_argument("--repeat", type=int, nargs=3, metavar=("SEED", "COUNT", "CASE"), help="one case of a door, here")
    return options


def main(words: list[str] | None = None) -> int:
    """Return 0 if nothing was found, 1 otherwise."""
    wanted = parser().parse_args(words)
    if wanted.repeat:
        seed, count, case = wanted.repeat
        findings = [finding for _, _, finding in ask(Batch(wanted.only, seed, count), case, case) if finding]
        print(*findings, sep="\n")
        return bool(findings)
    report = campaign(batches(wanted.cases, wanted.seed, wanted.only), wanted.jobs)
    print(report.text())
    return 1 if report.found or not report.asked else 0


if __name__ == "__main__":
    sys.exit(main())
