"""Where other engines are better, metric by metric and family of scenes by family: a table that leaves no metric out.

A family is a scene with its variants (other frame rates, other clips): sentences count families, so that one weakness that shows
in seven variants of one scene counts once, and the worst of the seven is named.
"""

import math
from collections.abc import Container, Iterable, Mapping, Sequence

from reports.deciding import piles
from reports.deciding.moments import Instants, moment
from reports.reading.load import Results, Row
from reports.words.metric_words import words
from reports.words.wording import count, factor, families, limit, listed
from runfiles.behind import BEST, Behind, Compared, MetricLosses, aside, by_family
from runfiles.like_for_like import TIME
from runfiles.metrics import METRICS
from runfiles.ranked import KINDS, RANKED, UNRANKED
from runfiles.timing_protocol import brief, repeats_of

FIRST = 4
"""Metrics that stand on the page before the reader asks for more: those in which most families are lost."""
TIMES = ("frame_time_p50", "frame_time_p95", "frame_time_p99", "frame_time_max")
"""Metrics that stand there whatever their place in that order: what a frame costs is asked first of an engine."""
WITHOUT = " without an avatar"
"""Which families are those of frame times."""
MOST_NAMED = 3
"""Metrics that the sentence names."""
MOST_BEHIND = 6
"""Families that a sentence on one metric names."""


def beside(one: Behind) -> str:
    """The factor as it stands beside two figures; "" where there is none: theirs is 0, or ours is no number."""
    return "" if math.isinf(one.factor) else factor(one.factor)


def sentence(found: Sequence[MetricLosses], ours: str) -> str:
    """What to conclude, losses first."""
    if not found:
        return "No other engine took part in this run, so nothing is ranked."
    lost = _most_lost_first(one for one in found if one.lost)
    if not lost:
        return f"No other engine is better than {ours} in any of {count(len(found), 'ranked metric')}."
    most = "; ".join(f"{words(one.metric)} in {one.said}" for one in lost[:MOST_NAMED])
    level = f" In {count(len(found) - len(lost), 'metric')} none is better anywhere." if len(lost) < len(found) else ""
    ranked = count(len(found), "ranked metric")
    return f"Some other engine is better than {ours} in {len(lost)} of {ranked}, most often: {most}.{level}"


def best_in(found: Compared, family_of: Mapping[str, str], metric: str) -> str:
    """In how many families ours is best or level in a metric and where not, the largest factor first: every sentence of the page
    that counts families of one metric asks here. "" where none was ranked."""
    one = next((one for one in by_family(found, family_of) if one.metric == metric), None)
    if one is None:
        return ""
    which = WITHOUT if metric.startswith(TIME) else ""
    said = f"{one.families - len(one.lost)} of {families(one.families)}{which}"
    where = tuple(" ".join(filter(None, [lost.worst.row.scenario, f"({beside(lost.worst)})" if beside(lost.worst) else ""]))
                  for lost in one.lost)
    return f"{said}{f', behind in {listed(where, MOST_BEHIND)}' if where else ''}"


def aside_said(found: Compared, family_of: Mapping[str, str]) -> str:
    """What of the frame times is not ranked, counted in families; "" where all is."""
    parts = []
    for metric in TIMES:
        one = aside(found, family_of, metric)
        said = [f"with an avatar, side by side, another engine takes less time in {one.less} of {families(one.avatar)}"] \
            if one.avatar else []
        said += [f"in {families(one.asleep)} what rests sleeps in that frame"] if one.asleep else []
        said += [f"in {families(one.few)} frames or repeats are too few, in {one.less_of_few} of them another engine takes less "
                 "time"] if one.few else []
        parts += [f"{words(metric)}: {', '.join(said)}"] if said else []
    return f"Times that are not ranked: {'; '.join(parts)}." if parts else ""


def repeats_said(results: Results, ours: str) -> str:
    """In how many scenes the frames by which engines are compared ran once; "" where none did, or no note says it."""
    timed = [row for row in results.rows if (row.run, row.metric) == (ours, TIMES[0]) and row.value is not None]
    repeats = [repeats_of(row.note) for row in timed]
    once = repeats.count(1)
    return f"Engines are compared over frames of 1 repeat in {once} of {count(len(repeats), 'scene')}." if once else ""


def section(
    results: Results, found: Compared, ours: str, known: Mapping[str, Instants] | None = None,
) -> dict[str, object]:
    """What the template of the losses is made of; `known`: when figures of ours are largest in each scene."""
    made = _most_lost_first(by_family(found, results.families))
    lost = [one for one in made if one.lost]
    shown = count(len(lost), "metric") if len(lost) <= FIRST else f"the first {FIRST} of {count(len(lost), 'metric')}"
    times = [one for metric in TIMES for one in made if one.metric == metric and one not in lost[:FIRST]]
    return {
        "lost_shown": shown, "lost_kinds": kinds_sentence(made, _unsayable(found)),
        "lost_silent": silent_sentence(found), "lost_at": lambda one: at(results, one, ours, known),
        "lost_first": [*lost[:FIRST], *times], "lost_all": lost, "lost_piles": piles.in_motion(results, ours),
        "lost_nowhere": [one for one in made if not one.lost],
        "lost_said": sentence(made, ours), "lost_rule": BEST, "lost_beside": beside, "unranked": UNRANKED,
        "same": same, "lost_over": over,
        "lost_aside": " ".join(filter(None, [repeats_said(results, ours), aside_said(found, results.families)])),
        "lost_which": lambda one: WITHOUT if one.metric in TIMES else "",
    }


def kinds_sentence(found: Sequence[MetricLosses], silent: Container[str] = ()) -> str:
    """How many of the ranked metrics measure the same thing, and in how many of them another engine is better: kind by kind, with
    the sum; `silent`: metrics that no other engine has words for in some scenes, beside which stands in how many families they
    are ranked."""
    by_name = {one.metric: one for one in found}
    said = []
    for kind, metrics in KINDS.items():
        ranked = [by_name[metric] for metric in metrics if metric in by_name]
        if ranked:
            alone = tuple(f"{words(one.metric)} in {families(one.families)} alone" for one in ranked if one.metric in silent)
            why = f" ({listed(alone)}: in others no other engine has words for it)" if alone else ""
            said.append(f"{kind} {sum(bool(one.lost) for one in ranked)} of {len(ranked)}{why}")
    total = f"; together {sum(bool(one.lost) for one in found)} of {len(found)}"
    return f"By what is measured, lost of ranked metrics: {'; '.join(said)}{total}." if said else ""


def _unsayable(found: Compared) -> frozenset[str]:
    """Metrics that are not ranked in some scene because no other engine that is there has words for them."""
    return frozenset(metric for pairs in found.silent.values() for _, metric in pairs - found.pairs)


def silent_sentence(found: Compared) -> str:
    """How many figures do not judge an engine that has no words for them; "" where there are none."""
    metrics: dict[str, dict[str, None]] = {}
    for run, pairs in found.silent.items():
        for _, metric in sorted(pairs):
            metrics.setdefault(words(metric), {})[run] = None
    if not metrics:
        return ""
    said = "; ".join(f"{metric} ({listed(tuple(runs))})" for metric, runs in metrics.items())
    number = sum(len(pairs) for pairs in found.silent.values())
    return f"Not ranked, because the engine has no words for it, are {count(number, 'figure')}: {said}."


def at(results: Results, one: Behind, ours: str, known: Mapping[str, Instants] | None = None) -> str:
    """"#t=0.341667", the time [s] of our largest figure in a scene, for the metrics of which the run kept a series or that are
    `known` from its recordings; else ""."""
    return moment(results, one.row.scenario, ours, one.row.metric, known)


def over(one: Behind) -> str:
    """Over how many repeats and frames a time of ours is, "3 x 200 frames"; "" for what is no time, or does not say."""
    row = one.row
    return brief(row.note.partition(";")[0]) if isinstance(row, Row) and row.metric in TIMES else ""


def same(metric: str) -> str:
    """The difference that counts as equal, as text."""
    rule = RANKED[metric]
    if rule.share:
        return f"{rule.share:.0%}"
    return limit(rule.same, METRICS[metric][0]) if rule.same and metric in METRICS else "none"


def _most_lost_first(found: Iterable[MetricLosses]) -> list[MetricLosses]:
    return sorted(found, key=lambda one: -len(one.lost) / one.families)
