"""A million stratified pairs against exact answers: python -m tests.collision.fuzz [--pairs N] [--large N] [--seed S] [--jobs J].

Prints one row per stratum (see `Verdict` in judged.py) and every failure's label; `--pair LABEL` judges that pair alone.
Exits with 1 when any pair fails.
"""

import argparse
import sys
from collections.abc import Iterator

import numpy as np
from joblib import Parallel, delayed

from tests.collision.judged import Tally, judge, tally
from tests.collision.strata import BATCH, STRATA, draw
from tests.progress_bar import bar

BATCHES_AT_ONCE = 5
"""Batches sent to a process at a time: larger makes the progress bar coarse, smaller spends more on sending."""
SHOWN = 40
"""Failures printed; the count is printed anyway."""


def chunks(pairs: int, large: int, seed: int) -> Iterator[tuple[str, int, range, int]]:
    """Yield arguments of `tally` that together are `pairs` pairs, shared out evenly over the strata, and `large` large ones."""
    strata = [s for s in STRATA if s != "large"]
    wanted = {s: pairs // len(strata) + (k < pairs % len(strata)) for k, s in enumerate(strata)} | {"large": large}
    for stratum, count in wanted.items():
        step = BATCHES_AT_ONCE * BATCH
        for first in range(0, count, step):
            here = min(step, count - first)
            numbers = range(first // BATCH, (first + here + BATCH - 1) // BATCH)
            yield stratum, seed, numbers, here


def named(chunk: tuple[str, int, range, int]) -> tuple[str, Tally]:
    """Return the tally of a chunk, with its stratum."""
    return chunk[0], tally(*chunk)


def table(found: dict[str, Tally]) -> str:
    """Return one row per stratum: pairs, worst figures relative to size, statuses, failures, and the pairs of each oracle."""
    head = f"{'stratum':12} {'pairs':>8} {'gap':>8} {'points':>8} {'swapped':>8} {'signs':>5} {'lost':>5} {'failed':>6}"
    return "\n".join([head, *(
        f"{name:12} {t.pairs:8} {t.error:8.1e} {t.witness:8.1e} {t.swapped:8.1e} {t.wrong_signs:5} {t.statuses.total():5} "
        f"{len(t.failures):6}  {dict(t.oracles)}" for name, t in found.items()
    )])


def show(label: str) -> bool:
    """Judge one pair and print the verdict; returns whether it is right."""
    stratum, seed, number, k = label.split("/")
    verdict = judge(draw(stratum, int(seed), int(number)), int(k.split()[0]))
    print(verdict, "Failures:", ", ".join(verdict.failures) or "none", sep="\n")
    return not verdict.failures


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=1_000_000, help="pairs of shapes of up to 64 corners")
    parser.add_argument("--large", type=int, default=2_000, help="pairs of hulls of up to 300 corners on top")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=-1, help="processes; -1: one per core")
    parser.add_argument("--pair", help="judge the pair with this label alone")
    chosen = parser.parse_args()
    if chosen.pair:
        return 0 if show(chosen.pair) else 1
    found: dict[str, Tally] = {}
    work = list(chunks(chosen.pairs, chosen.large, chosen.seed))
    # Kernels are compiled here once, so that the processes find them in the cache.
    tally("smooth-deep", chosen.seed, range(1), BATCH)
    tally("shallow", chosen.seed, range(1), BATCH)
    done = Parallel(n_jobs=chosen.jobs, return_as="generator_unordered")(delayed(named)(chunk) for chunk in work)
    with bar(chosen.pairs + chosen.large, "pair") as shown:
        for name, part in done:
            found.setdefault(name, Tally()).join(part)
            shown.update(part.pairs)
    found = {name: found[name] for name in STRATA if name in found}
    print(table(found))
    failures = sorted(failure for t in found.values() for failure in t.failures)
    for failure in failures[:SHOWN]:
        print(failure)
    if failures:
        print(f"{len(failures)} of {sum(t.pairs for t in found.values())} pairs failed. One again:")
        print(f"    python -m tests.collision.fuzz --pair {failures[0].split()[0]}")
    elif not np.isfinite([t.error for t in found.values()]).all():
        return 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
