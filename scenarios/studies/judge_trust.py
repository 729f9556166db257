"""The check of the judge's accuracy within a comparison: pairs of known distance, drawn anew for every version."""

import sys

from avatarsim.errors import MissingPackage
from runfiles.table import Row
from scenarios.run.progress import Progress
from scenarios.run.provenance import code_hash
from scenarios.studies.study import Request, Study

SEEDS = 2**32
"""Seeds are drawn from below this: it fits into a command line and into every generator."""


def seed() -> int:
    """Return the seed from the hash of all sources: pairs that no earlier version was mended for."""
    return int(code_hash(), 16) % SEEDS


def ask(request: Request) -> tuple[list[Row], list[str]]:
    """Examine the judge and write judge.json into the run's folder. Raises MissingPackage without the judge's packages."""
    try:
        from reference.judge_trust import PAIRS, command, trust, write
        from reference.judging.known_pairs import KINDS
    except ImportError as error:
        raise MissingPackage(str(error.name), "compare", "the judge and its second opinion") from error
    draw_seed = seed()
    with Progress("judge", len(KINDS), sys.stderr, part=True) as progress:
        write(trust(PAIRS, draw_seed, progress.step), request.folder, command(PAIRS, draw_seed))
    return [], []


STUDY = Study("judge", ask)
