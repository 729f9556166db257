"""How far the judge may be trusted, from what `python -m reference.judge_trust`, or the comparison itself, left in the run."""

import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json
from reports.words.wording import count, quantity
from runfiles.csv_rows import DAMAGED

FILE, SCHEMA_VERSION = "judge.json", 1


@dataclass(frozen=True)
class Examined:
    """Pairs of one kind; see `reference.judge_trust.Examined`."""

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
    """An examination: all pairs together, kind by kind, and how to ask again."""

    whole: Examined
    kinds: tuple[Examined, ...]
    command: str
    ended: str
    sources: str
    versions: tuple[tuple[str, str], ...]
    promise: float

    @property
    def kept(self) -> bool:
        """Whether the judge was within its promise on every pair; a pair without an answer breaks it."""
        return self.whole.largest_error <= self.promise


def load(run_dir: Path) -> Trust | None:
    """The file of a run; None when there is none. Raises InvalidFile for a file that is damaged or of another layout."""
    path = run_dir / FILE
    if not path.exists():
        return None
    found: Any = read_json(path, str(path), "the whole file of one examination")
    try:
        if found["schema_version"] != SCHEMA_VERSION:
            raise InvalidFile(f"schema_version of {path}", found["schema_version"], f"{SCHEMA_VERSION}; run again")
        return Trust(
            _examined(found["all"]), tuple(_examined(row) for row in found["kinds"]), str(found["command"]), str(found["ended"]),
            str(found["sources"]), tuple((str(name), str(text)) for name, text in found["versions"].items()),
            float(found["promise_m"]),
        )
    except DAMAGED as error:
        raise InvalidFile(str(path), f"{type(error).__name__}: {error}", "the whole file of one examination") from error


def _examined(row: dict[str, Any]) -> Examined:
    figures: dict[str, Any] = {entry.name: int(row[entry.name]) for entry in fields(Examined) if entry.type is int}
    figures |= {name: float(row[name]) for name in ("largest_error", "largest_depth_error")}
    return Examined(kind=str(row["kind"]), **figures)


def sentence(found: Trust) -> str:
    """What to conclude, what speaks against the judge first."""
    whole = found.whole
    if found.kept:
        kept = f"The judge is right to {quantity(whole.largest_error, 'm')} on each of {count(whole.pairs, 'pair')}"
    else:
        error = "it passed over a pair" if math.isnan(whole.largest_error) else f"it errs by {quantity(whole.largest_error, 'm')}"
        kept = f"The judge breaks its promise of {quantity(found.promise, 'm')}: {error} on {count(whole.pairs, 'pair')}"
    alarms = f"{count(whole.false_alarms, 'false alarm')} and {count(whole.misses, 'missed overlap')} at the bound of 1 µm"
    return f"{kept} whose exact depth or distance is known ({whole.overlapping:,} overlap); {alarms}."


def second(found: Trust) -> str:
    """What the second opinion says."""
    whole = found.whole
    silent = f" python-fcl ended without an answer on {count(whole.unanswered, 'pair')}." if whole.unanswered else ""
    if not whole.disagreements:
        return f"The second opinion, python-fcl, agrees to 1 µm on every pair that it answers.{silent}"
    share = 100.0 * whole.disagreements / whole.pairs
    sides = "each of them" if not whole.judge_wrong else f"all but {whole.judge_wrong} of them"
    return (
        f"The second opinion, python-fcl, differs by more than 1 µm on {whole.disagreements} pairs ({share:.0f} %; "
        f"{whole.overlapping_disagreements} overlap); the judge is nearer to the exact answer on {sides}.{silent}"
    )


def section(found: Trust) -> dict[str, object]:
    """What the section is made of."""
    return {"judge_sentence": sentence(found), "judge_second": second(found)}
