"""Reports: pages and summaries from the files of one run. Reads files, runs nothing."""

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from avatarsim.errors import InvalidFile

if TYPE_CHECKING:
    import pandas as pd

    from reports.tables.changes import Changes
    from reports.tables.checks import Checks
    from reports.tables.run import Run

PAGE, SUMMARY, JUNIT = "index.html", "summary.md", "junit.xml"

FILES = (SUMMARY, "results.csv", "settings.csv", "hard_cases.csv", "effects.csv", "contact_law.csv", "bench.csv")
"""Files that the page links, where the run has them."""

SHOWN = 5
"""Scenes of which the index shows stills."""

BASELINE = Path(__file__).with_name("baseline.csv")


@dataclass(frozen=True, eq=False)
class Judged:
    """A judged run, as all forms of a report show it."""

    run: "Run"
    checks: "Checks"
    changes: "Sequence[Changes]"
    losses: "pd.DataFrame"


def judged(folder: Path, before: Path | None = None, baseline: Path | None = None) -> Judged:
    """Judge a run; compare it with an earlier one, and with the committed baseline.

    Raises InvalidFile where results.json is missing, truncated or of another schema. An earlier run that cannot be read is left
    out. The last result is kept: a page and the summary in a terminal are of one judgement.
    """
    written = 0
    with suppress(OSError):
        # one that cannot be looked at is refused by the reader, in words
        written = (folder / "results.json").stat().st_mtime_ns
    return _judged(folder, before, baseline, written)


@lru_cache(maxsize=1)
def _judged(folder: Path, before: Path | None, baseline: Path | None, written: int) -> Judged:
    from reports.summaries.baseline import load
    from reports.tables.changes import against_baseline, changes
    from reports.tables.checks import checks
    from reports.tables.losses import losses
    from reports.tables.run import read

    run, comparisons = read(folder), []
    if before is not None:
        try:
            comparisons.append(changes(read(before), run))
        except InvalidFile:
            # an older layout is no reason to have no report
            pass
    if baseline is not None and baseline.exists():
        stored = load(baseline)
        if stored.scenario.isin(run.rows.scenario).any():
            comparisons.append(against_baseline(stored, run, "baseline"))
    return Judged(run, checks(run), comparisons, losses(run))


def write_report(folder: Path, before: Path | None = None, baseline: Path | None = None) -> tuple[str, ...]:
    """Write index.html, the pages beside it, a page per scene, summary.md and junit.xml.

    Damaged files of the run cost their scene or section: the pages name them, and so does a sentence each that is returned.
    All pages are made before one of them is replaced. Raises InvalidFile as `judged`; files in the folder then stay as they are.
    """
    verdict, damage = judged(folder, before, baseline), list[str]()
    _replace(folder, _texts(verdict, damage))
    return tuple(damage)


def terminal_summary(folder: Path, before: Path | None = None, baseline: Path | None = None) -> str:
    """Return the summary of a run for a terminal. Raises InvalidFile as `judged`."""
    from reports.summaries.text import terminal

    verdict = judged(folder, before, baseline)
    return terminal(verdict.run, verdict.checks, verdict.changes, verdict.losses)


def _texts(verdict: Judged, damage: list[str]) -> Iterator[tuple[str, str]]:
    """(path, text) of all files of a report; ``damage`` gets a sentence for each part that is left out."""
    from reports.pages import scripts
    from reports.pages.articles import articles
    from reports.pages.index import page
    from reports.pages.scene import scene_pages
    from reports.summaries.junit import junit
    from reports.summaries.text import markdown
    from reports.tables import contact_law, effects, hard_cases, settings

    tables: dict[str, pd.DataFrame | None] = {}
    run = verdict.run
    readers = {
        "settings": settings.settings, "cases": hard_cases.by_case, "effects": effects.effects, "law": contact_law.contact_law,
    }
    for name, load in readers.items():
        try:
            tables[name] = load(run.folder)
        except InvalidFile as error:
            tables[name] = None
            damage.append(str(error).replace(f"{run.folder}/", ""))
    tried = tables["settings"]
    shown = telling(verdict, [] if tried is None else list(dict.fromkeys(tried.scenario)))
    stills, instants, replayed = {}, {}, list[str]()
    for name, text, played in scene_pages(run, frozenset(shown)):
        stills[name], instants[name] = played.stills, played.instants
        replayed += [name] * (played.replay is not None)
        damage += [f"{name}: {fault}" for fault in played.damage]
        yield f"scenes/{name}.html", text
    for name, text in scripts.libraries().items():
        yield f"{scripts.LIBRARIES}/{name}", text
    pages = articles(run)
    yield from pages.items()
    yield JUNIT, junit(verdict.checks)
    yield SUMMARY, markdown(run, verdict.checks, verdict.changes, verdict.losses, damage)
    files = [name for name in FILES if name == SUMMARY or (run.folder / name).exists()]
    files += pages.keys() & {"bench.html"}
    # those since the last run; of a first run those since the baseline
    changes = next(iter(verdict.changes), None)
    pictures = {name: one for name in shown if (one := stills[name])}
    yield PAGE, page(run, verdict.checks, changes, tables, verdict.losses, pictures, replayed, instants, damage, files)


def telling(verdict: Judged, scenes: Sequence[str]) -> list[str]:
    """Return the scenes whose stills are shown: everyday ones, then avatars, then those in which other engines overlap most."""
    run = verdict.run
    rows = run.rows[(run.rows.metric == "residual_overlap_max") & run.rows.run.isin(run.runs)]
    rows = rows[rows.scenario.isin(scenes or run.rows.scenario)]
    others = rows[~rows.run.str.startswith(("tracker/", run.gated.partition("/")[0] + "/"))]
    depths = others.groupby("scenario").value.max().fillna(0.0)
    everyday, avatars = run.results.everyday, run.avatars
    return sorted(map(str, depths.index), key=lambda name: (name not in everyday, name not in avatars, -depths[name]))[:SHOWN]


def _replace(folder: Path, texts: Iterable[tuple[str, str]]) -> None:
    """Write each text beside its place; once all are there, move them in, the page that leads to the others last."""
    halves: list[tuple[Path, Path]] = []
    try:
        for name, text in texts:
            place = folder / name
            place.parent.mkdir(exist_ok=True)
            half_written = place.with_name(f".{place.name}.part")
            halves.append((half_written, place))
            # files of a run may hold half of a surrogate pair, which UTF-8 has no bytes for
            half_written.write_text(text, encoding="utf-8", errors="replace")
        for half_written, place in halves:
            os.replace(half_written, place)
    finally:
        for half_written, _ in halves:
            half_written.unlink(missing_ok=True)
