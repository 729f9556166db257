"""A card for every scene: its picture, its title, what the gate says, its worst figures, and whether another engine is better."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from reports.deciding.columns import COLUMNS
from reports.deciding.cut_short import cuts
from reports.deciding.seen_first import by_sight
from reports.deciding.tables import RAW_TRACKER, Block, engine_of
from reports.deciding.verdict import Verdict
from reports.reading.load import Results
from reports.words.metric_words import words
from reports.words.wording import count, quantity
from runfiles.behind import Behind, at_size

REFUSED = "refused"
"""Status of a run that declined its scene."""
OVERLAP = "overlap"
"""Key of the column whose largest figure a card names."""

ON_CARD = 2
"""Losses that a card names without being opened: those that are seen first."""


@dataclass(frozen=True)
class Picture:
    """The picture of a scene as SVG ("" where it has none) and the time [s] of the state in it."""

    svg: str
    time: float


@dataclass(frozen=True)
class Card:
    """What the index shows of a scene; `status` is a class of the style sheet, `said` the same in words, `figures` (what, text),
    `behind` every figure of this very scene in which another engine is better, what is seen first at the front, `cut` how much of
    a scene ran that was cut short, else ""."""

    scene: str
    title: str
    family: str
    status: str
    said: str
    figures: tuple[tuple[str, str], ...]
    behind: tuple[str, ...]
    picture: Picture
    cut: str = ""


def cards(results: Results, shown: Sequence[Block], verdict: Verdict, pictures: Mapping[str, Picture]) -> tuple[Card, ...]:
    """One card per scene, in the order of the table."""
    said, cut = _statuses(verdict), cuts(results)
    behind: dict[str, list[Behind]] = defaultdict(list)
    # of each scene, not of the worst of its family: a card speaks of its own scene
    for one in verdict.ranked.behind:
        behind[one.row.scenario].append(one)
    return tuple(
        Card(block.scene, block.title, results.family(block.scene), *said.get(block.scene, ("none", "no bound of the gate")),
             _figures(block, verdict.gated),
             tuple(_lost(one, results.scales.get(block.scene, 1.0)) for one in by_sight(behind[block.scene])),
             pictures.get(block.scene, Picture("", 0.0)),
             cut[block.scene].said if block.scene in cut else "")
        for block in shown
    )


def _lost(one: Behind, scale: float) -> str:
    """"jump of a link ... 473 mm, best other 89.1 mm (mujoco/tuned)", both as the scene shows them."""
    unit, metric = one.row.unit, one.row.metric
    run, best = one.rivals[0]
    more = f" and {len(one.rivals) - 1} more" if len(one.rivals) > 1 else ""
    return f"{words(metric)} {quantity(at_size(one.value, unit, scale), unit)}, best other " \
           f"{quantity(at_size(best, unit, scale), unit)} ({run}{more})"


def families(found: Sequence[Card]) -> tuple[tuple[str, int], ...]:
    """(family, number of its scenes), the largest first, then by name."""
    sizes: dict[str, int] = defaultdict(int)
    for card in found:
        sizes[card.family] += 1
    return tuple(sorted(sizes.items(), key=lambda one: (-one[1], one[0])))


def sentence(found: Sequence[Card]) -> str:
    """How many scenes there are, and in how many of them another engine is better in something."""
    lost = sum(bool(card.behind) for card in found)
    better = f"in {lost} of them another engine is better in at least one measure" if lost else (
        "in none of them is another engine better in a ranked measure")
    number = len(families(found))
    return f"{count(len(found), 'scene')} in {number} {'family' if number == 1 else 'families'}; {better}."


def _statuses(verdict: Verdict) -> dict[str, tuple[str, str]]:
    """By scene the worst that the gate says of it, as (class, words)."""
    rows: dict[str, dict[str, int]] = defaultdict(lambda: defaultdict(int))
    for name, group in (("failed", verdict.failed), ("crashed", verdict.crashed), ("unmeasured", verdict.unmeasured),
                        ("waived", verdict.waived), ("passed", verdict.passed), ("neutral", verdict.neutral)):
        for row in group:
            if row.run == verdict.gated:
                rows[row.scenario][row.status if name == "neutral" else name] += 1
    return {scene: _status(tally) for scene, tally in rows.items()}


def _status(tally: Mapping[str, int]) -> tuple[str, str]:
    gated = sum(tally.get(name, 0) for name in ("failed", "waived", "passed"))
    if tally.get("failed"):
        return "failed", f"{tally['failed']} of {count(gated, 'check')} failed"
    if tally.get("crashed"):
        return "crashed", "crashed"
    if tally.get("unmeasured"):
        return "not-measured", f"{tally['unmeasured']} not measured"
    if tally.get("waived"):
        return "waived", f"{tally['waived']} of {count(gated, 'check')} waived"
    if tally.get("passed"):
        return "passed", f"all {count(gated, 'check')} pass" if gated > 1 else "its check passes"
    if tally.get("refused"):
        return "refused", "refused, as it should be"
    return "none", "cannot be said"


def _figures(block: Block, ours: str) -> tuple[tuple[str, str], ...]:
    """Our largest overlap beside the largest of the other engines; nothing of a scene that ours refuses: how deep others are
    there is the pose that the scene prescribes."""
    if any(cell.word == REFUSED for line in block.lines if line.ours for cell in line.cells):
        return ()
    column = next(k for k, column in enumerate(COLUMNS) if column.key == OVERLAP)
    own = next((line.cells[column].value for line in block.lines if line.ours), None)
    theirs = [(value, line.run) for line in block.lines if engine_of(line.run) not in (RAW_TRACKER, engine_of(ours))
              and (value := line.cells[column].value) is not None]
    found = [("overlap", f"{quantity(own, 'm')} ({ours.partition('/')[0]})")] if own is not None else []
    if theirs:
        # what is no number is worse than any
        value, run = max(theirs, key=lambda one: (one[0] != one[0], one[0]))
        found.append(("others up to", f"{quantity(value, 'm')} ({run})"))
    return tuple(found)
