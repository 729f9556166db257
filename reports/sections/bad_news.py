"""Bad news first: the largest losses that a screen shows, metric by metric in the order of `seen_first`, each with its moment."""

from collections.abc import Mapping
from dataclasses import dataclass

from reports.deciding.cut_short import cuts
from reports.deciding.moments import Instants, address, moment
from reports.deciding.seen_first import SEEN
from reports.reading.load import Results
from reports.sections.page_paths import path_of
from reports.sections.unseen import is_room
from reports.words.metric_words import words
from reports.words.wording import quantity
from runfiles.behind import Compared, at_size, by_family

MOST = 7
"""Losses that stand there: more are a list that is passed over, fewer leave out how far an avatar is from its user."""


@dataclass(frozen=True)
class News:
    """What is bad, the place where it can be seen, and what stands beside it."""

    said: str
    path: str
    beside: str


def news(results: Results, found: Compared, ours: str, known: Mapping[str, Instants]) -> tuple[News, ...]:
    """Of every metric that a screen shows and in which another engine is better somewhere, our largest figure there, beside a
    scene that was cut short how much of it ran; and the longest wait in a room of motions that nothing was tuned for."""
    cut = cuts(results)
    losses = {one.metric: one for one in by_family(found, results.families)}
    made = list[News]()
    for metric in SEEN:
        worst = losses[metric].largest if metric in losses else None
        if worst is None or len(made) == MOST:
            continue
        scene, unit = worst.row.scenario, worst.row.unit
        scale = results.scales.get(scene, 1.0)
        run, best = worst.rivals[0]
        made.append(News(
            f"{words(metric)} {quantity(at_size(worst.value, unit, scale), unit)}",
            f"{path_of(scene)}{moment(results, scene, ours, metric, known)}",
            f"{scene}{f', {cut[scene].within}' if scene in cut else ''}; {run} {quantity(at_size(best, unit, scale), unit)}"))
    return (*made, *waiting(known))


def waiting(known: Mapping[str, Instants]) -> tuple[News, ...]:
    """The longest wait in a room of motions that nothing was tuned for; nothing where no avatar waits there."""
    waits = [(one.wait, scene) for scene, one in known.items() if one.wait is not None and is_room(scene)]
    if not waits:
        return ()
    (length, begin), scene = max(waits)
    return (News(f"an avatar waits up to {quantity(length * 1e6, 'us')}", f"{path_of(scene)}{address(begin)}",
                 f"{scene}; held off its user, no path known"),)
