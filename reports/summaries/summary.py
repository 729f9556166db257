"""`summary.md`: the run in the order in which a reviewer needs it. What we lose stands first."""

from collections.abc import MutableSequence
from functools import partial

from reports.deciding import losses
from reports.deciding.columns import COLUMNS
from reports.deciding.conclusions import CAVEAT, KINEMATIC, hover_notes, ratio_sentence
from reports.deciding.marked import cell_note
from reports.deciding.tables import Block, Line, blocks
from reports.deciding.verdict import Verdict, believed, loosest, reading_order, scenes_sentence
from reports.page.extra_sections import tried
from reports.reading.load import Results
from reports.sections import closeness, own_scenes, table_2
from reports.sections.closeness import Closeness, near_sentence, pair_sentence
from reports.sections.sweep import points
from reports.sections.sweep.points import Sweep
from reports.sections.table_2 import Table2, markdown
from reports.words.markdown import code, escaped
from reports.words.metric_words import words
from reports.words.wording import MISSING, count, quantity, ratio
from runfiles.behind import by_family

# Losses listed before the rest becomes a number.
MOST_LOSSES = 20


def summary(results: Results, verdict: Verdict, two: Table2 | None = None, close: Closeness | None = None,
            damage: MutableSequence[str] | None = None, sweep: Sweep | None = None) -> str:
    """The document as Markdown text, ending in a newline; to `damage` comes why a part cannot be told. `sweep`: what
    names the cheapest settings of a user's own scenes."""
    damage = [] if damage is None else damage
    parts = [f"## {verdict.word.upper()}: {escaped(verdict.sentence)}",
             *_own(results, sweep, damage), KINEMATIC, _counts(verdict),
             escaped(" · ".join(loosest(results, verdict))), *_troubles(verdict), *_losses(results, verdict)]
    shown = blocks(results, reading_order(results, verdict))
    if shown:
        hovering = escaped(" ".join(hover_notes(results)))
        parts += ["### All scenes", CAVEAT, _table(shown, verdict.gated), ratio_sentence(), hovering]
    else:
        parts.append("No row was measured: the filter matched nothing, or the run ended before its first scene.")
    if two:
        parts += tried(table_2.FILES, partial(_paper, two), damage) or []
    if close:
        parts += tried(closeness.FILES, partial(_nearness, close), damage) or []
    told = [f"{key} {value}" for key, value in results.provenance.items() if isinstance(value, str | int | float)]
    parts.append(f"{escaped('; '.join(told))}." if told else "The results say nothing about where they come from.")
    return "\n\n".join(part for part in parts if part) + "\n"


def _own(results: Results, sweep: Sweep | None, damage: MutableSequence[str]) -> list[str]:
    return [escaped(said) for said in tried(points.FILES, partial(own_scenes.least, results, sweep), damage) or ()]


def _paper(two: Table2) -> list[str]:
    return ["### Table 2 of the paper, and its Figure 8", markdown(two)]


def _nearness(close: Closeness) -> list[str]:
    near = ["### Beside the nearest free posture", escaped(near_sentence(close.near))] if close.near else []
    heading = f"### Distance from the user beside {escaped(close.pairs[0].other)}" if close.pairs else ""
    return [*near, heading, escaped(pair_sentence(close.pairs))] if close.pairs else near


def _counts(verdict: Verdict) -> str:
    return f"{escaped(scenes_sentence(verdict))} Gate: {code(verdict.gated)}."


def _troubles(verdict: Verdict) -> list[str]:
    """One list item per run that crashed or was not measured."""
    rows = []
    for row in verdict.crashed + verdict.unmeasured:
        metric = f" {escaped(row.metric)}" if row.metric not in ("", "run") else ""
        reason = escaped(row.note) or "no reason given"
        rows.append(f"- **{row.status}** {escaped(row.scenario)}, {code(row.run)}{metric}: {reason}")
    return ["### Crashed or not measured", "\n".join(rows)] if rows else []


def _losses(results: Results, verdict: Verdict) -> list[str]:
    if not verdict.losses:
        rivals = "no other engine did better in any ranked metric" if verdict.rivals else "no other engine took part"
        return ["### What we lose", f"Nothing that this run can show: no bound failed, and {rivals}."]
    every = by_family(verdict.ranked, results.families)
    lines = ["| scene | measure | ours | theirs, or the limit |", "|---|---|---:|---|"]
    for loss in verdict.losses[:MOST_LOSSES]:
        factor = f" ({escaped(loss.beside)})" if loss.beside else ""
        strong = "**" if loss.kind == "failed" else ""
        what, ours = f"{strong}{escaped(words(loss.what))}{strong}", f"{escaped(loss.ours)}{factor}"
        lines.append(f"| {escaped(loss.scene)} | {what} | {ours} | {escaped(loss.theirs)} |")
    more = len(verdict.losses) - MOST_LOSSES
    after = [f"And {count(more, 'smaller one')}; see index.html."] if more > 0 else []
    return ["### What we lose, worst first", escaped(losses.sentence(every, verdict.gated)),
            escaped(losses.silent_sentence(verdict.ranked)), "\n".join(lines), *after]


def _table(shown: tuple[Block, ...], ours: str) -> str:
    head = ["scene", "engine", *(column.title for column in COLUMNS)]
    lines = ["| " + " | ".join(head) + " |", "|---|---|" + "---:|" * len(COLUMNS)]
    for block in shown:
        for line in block.lines:
            name = f"**{escaped(line.run)}**" if line.ours else escaped(line.run)
            trouble = f" {escaped(line.trouble)}" if line.trouble and not line.nothing else ""
            cells = escaped(line.nothing) + " |" * (len(COLUMNS) - 1) if line.nothing else _cells(line, ours)
            lines.append(f"| {escaped(block.scene)} | {name}{trouble} | {cells} |")
    return "\n".join(lines)


def _cells(line: Line, ours: str) -> str:
    texts = []
    for cell in line.cells:
        text = escaped(cell.word or quantity(cell.value, cell.row.unit if cell.row else ""))
        word = believed(cell.row, ours) if cell.row else ""
        if cell.row and cell.row.metric == "frame_time_p50" and cell.value is not None and (how := cell_note(cell, ours)[1]):
            text += f" [{escaped(how)}]"
        text = f"**{text} ✕**" if word == "fail" else f"{text} waived" if word == "waived" else text
        if cell.ratio is not None and text != MISSING:
            text += " (best)" if cell.best else f" ({ratio(cell.ratio)})" if cell.ratio > 1.0 else ""
        texts.append(text)
    return " | ".join(texts)
