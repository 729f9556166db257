"""Measure how far the judge may be trusted: `python -m reference.judge_trust [--pairs N] [--seed N] [--run FOLDER]`.

Draws pairs of shapes whose signed distance is known exactly, queries the judge and, as a second opinion, python-fcl, and counts
errors, disagreements, and verdicts on the wrong side of the bound of 1 um. Writes judge.json into the run's folder.
"""

import argparse
import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, fields
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.console import ended, path_option
from avatarsim.errors import InvalidInput
from avatarsim.spatial import rotation
from reference.judging.in_fcl import Question, fcl_distances
from reference.judging.judge import Judge
from reference.judging.known_pairs import KINDS, REACH, REGIMES, Gallery, Placed
from reference.judging.proof import PROVEN
from runfiles.files import OUT, last_comparison

Array = NDArray[np.float64]

FILE, SCHEMA_VERSION = "judge.json", 1
"""Name of the file left in a run's folder, for the report, and version of its layout."""
BOUND = 1e-6
"""Depth [m] at which a verdict turns: the bound on residual overlap."""
SAME = 1e-6
"""Distance [m] up to which two answers agree: the bound on residual overlap, so that a disagreement is one that could turn a
verdict. fcl leaves up to 0.4 mm between separated rounded shapes; a smaller figure counts more of that."""
PAIRS = 2400
"""Pairs of one examination, over all kinds and regimes: some eight seconds on two processors."""
SEED = 1
"""Seed of a command that names none."""
GALLERY = 50
"""Most pairs in one scene: near pairs are looked for among all of it."""
COMMAND = "python -m reference.judge_trust"


def command(pairs: int, seed: int) -> str:
    """Return the command that repeats the check."""
    return f"{COMMAND} --pairs {pairs} --seed {seed}"



@dataclass(frozen=True)
class Examined:
    """Results for the pairs of one kind.

    overlapping                pairs whose exact depth is above 0
    largest_error              [m] of the judge's signed distance, over all pairs; nan if it passed over one
    largest_depth_error        [m] largest error over the pairs that overlap
    unanswered                 pairs for which python-fcl had no number, since its process ended or it returned nan
    disagreements              pairs on which python-fcl and the judge differ by more than 1 um
    overlapping_disagreements  those of them that overlap
    judge_wrong                those of them on which the exact answer is nearer to python-fcl's
    false_alarms               the judge reports more than 1 um, and the exact depth is at most that
    misses                     the other way round
    at_the_bound               pairs so near to a depth of 1 um that the promised accuracy cannot decide
    """

    kind: str
    pairs: int
    overlapping: int
    largest_error: float
    largest_depth_error: float
    unanswered: int
    disagreements: int
    overlapping_disagreements: int
    judge_wrong: int
    false_alarms: int
    misses: int
    at_the_bound: int


@dataclass(frozen=True)
class Trust:
    """All kinds of one examination, and the seed of its draws."""

    seed: int
    kinds: tuple[Examined, ...]

    @property
    def whole(self) -> Examined:
        """The kinds together: counts summed, errors the largest."""
        figures: dict[str, Any] = {name: sum(getattr(kind, name) for kind in self.kinds) for name in COUNTS}
        # a judge that gave no number has no error that could be called small, and numpy's max keeps nan
        figures |= {name: float(np.max([getattr(kind, name) for kind in self.kinds])) for name in ERRORS}
        return Examined("all", **figures)


ERRORS = ("largest_error", "largest_depth_error")
COUNTS = tuple(entry.name for entry in fields(Examined) if entry.name not in ("kind", *ERRORS))
"""Figures of which the kinds together have the largest, and those of which they have the sum."""


def trust(pairs: int = PAIRS, seed: int = SEED, done: Callable[[str], None] = lambda kind: None) -> Trust:
    """Examine the judge on `pairs` over all kinds, rounded up to whole regimes; `done` is called with each kind that is judged.

    Raises InvalidInput for fewer than one pair a kind, or a negative seed."""
    if seed < 0:
        raise InvalidInput("seed", seed, "0 at least")
    if pairs < len(KINDS):
        raise InvalidInput("pairs", pairs, f"{len(KINDS)} at least, one of each kind")
    each = -(-pairs // (len(KINDS) * len(REGIMES)))
    by_kind = {kind: list(draws(kind, each, np.random.default_rng([seed, k]))) for k, kind in enumerate(KINDS)}
    questions = [question for parts in by_kind.values() for part in parts for question in part.questions]
    with ThreadPoolExecutor(1) as executor:
        # the second opinion has a process of its own, which works while the judge does
        awaited = executor.submit(fcl_distances, questions)
        judged: dict[str, Array] = {}
        for kind, parts in by_kind.items():
            judged[kind] = np.concatenate([part.judged() for part in parts])
            done(kind)
        other = awaited.result()
    ends = np.cumsum([len(distances) for distances in judged.values()])
    return Trust(seed, tuple(
        counted(kind, np.concatenate([part.placed.exact for part in by_kind[kind]]), judged[kind], opinion)
        for kind, opinion in zip(by_kind, np.split(other, ends[:-1]), strict=True)
    ))


@dataclass(frozen=True, eq=False)
class Draw:
    """A gallery placed once, as queries to the judge and to python-fcl."""

    gallery: Gallery
    placed: Placed

    @property
    def questions(self) -> list[Question]:
        """Return the pairs for python-fcl, one by one."""
        n, at, turns = len(self.gallery.shapes), self.placed.positions, rotation.to_matrix(self.placed.orientations)
        return [(a, turns[k], b, turns[n + k], at[k] - at[n + k]) for k, (a, b) in enumerate(self.gallery.shapes)]

    def judged(self) -> Array:
        """Return the judge's signed distances (n,) [m]; nan for a pair that it passed over, which so has no small error."""
        first, second, distances = Judge(self.gallery.scene).distances(self.placed.positions, self.placed.orientations, REACH)
        answers = np.full(len(self.gallery.shapes), np.nan)
        answers[np.minimum(first, second)] = distances
        return answers


def draws(kind: str, each: int, random: np.random.Generator) -> Iterator[Draw]:
    """Yield `each` pairs of one kind in every regime, in galleries of at most GALLERY."""
    for begun in range(0, each, GALLERY):
        gallery = Gallery(kind, min(GALLERY, each - begun), random)
        for regime in REGIMES:
            yield Draw(gallery, gallery.placed(regime, random))


def counted(kind: str, exact: Array, judged: Array, other: Array) -> Examined:
    """Return the figures of (n,) exact, judged and python-fcl's signed distances [m]."""
    errors, deep = np.abs(judged - exact), exact < 0.0
    silent = np.isnan(other)
    differ = ~silent & ~(np.abs(judged - other) <= SAME)
    above = exact < -BOUND
    return Examined(
        kind, len(exact), int(deep.sum()), float(errors.max()), float(errors[deep].max(initial=0.0)), int(silent.sum()),
        int(differ.sum()), int((differ & deep).sum()), int((differ & ~(errors <= np.abs(other - exact))).sum()),
        int((~above & (judged < -BOUND)).sum()), int((above & ~(judged < -BOUND)).sum()),
        int((np.abs(exact + BOUND) <= PROVEN).sum()),
    )


def sources() -> str:
    """Return sixteen hexadecimal digits of this file and of all in `judging`: the judge and its references."""
    digest = hashlib.blake2b(digest_size=8)
    for path in (Path(__file__), *sorted(Path(__file__).with_name("judging").glob("*.py"))):
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def write(result: Trust, folder: Path, invocation: str) -> Path:
    """Write judge.json in `folder`, whole or not at all; `invocation` is the command that repeats the check."""
    content: Mapping[str, object] = {
        "schema_version": SCHEMA_VERSION, "command": invocation, "ended": datetime.now(UTC).isoformat(timespec="seconds"),
        "sources": sources(), "versions": {name: metadata.version(name) for name in ("coal", "python-fcl")},
        "seed": result.seed, "bound_m": BOUND, "promise_m": PROVEN, "same_m": SAME, "regimes": REGIMES,
        "all": asdict(result.whole), "kinds": [asdict(kind) for kind in result.kinds],
    }
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / FILE
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    # a judge without a number leaves the word NaN, which the report reads
    temporary.write_text(json.dumps(content, indent=1), encoding="utf-8")
    os.replace(temporary, path)
    return path


def main(argv: Sequence[str] | None = None) -> int:
    """Examine, print, write. 0: the judge keeps its promise; 1: it does not; 2: usage."""
    parser = argparse.ArgumentParser(prog=COMMAND, description=str(__doc__).splitlines()[0])
    parser.add_argument("--pairs", type=int, default=PAIRS, metavar="N", help=f"pairs over all kinds ({PAIRS})")
    parser.add_argument("--seed", type=int, default=SEED, metavar="N", help=f"seed of the draws ({SEED})")
    parser.add_argument("--run", type=path_option, metavar="FOLDER", help="folder of the file (default: the last comparison)")
    args = parser.parse_args(argv)
    try:
        result = trust(args.pairs, args.seed)
    except InvalidInput as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    for line in (*result.kinds, result.whole):
        print(
            f"{line.kind:24} {line.pairs:6} pairs  {line.overlapping:6} overlap  error {line.largest_error:.2g} m  "
            f"fcl differs {line.disagreements} (right {line.judge_wrong})  false alarms {line.false_alarms}  misses {line.misses}"
        )
    print(write(result, args.run or last_comparison(OUT, "judge"), command(args.pairs, args.seed)))
    return 0 if result.whole.largest_error <= PROVEN else 1


if __name__ == "__main__":
    sys.exit(ended(main))
