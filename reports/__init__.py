"""Reports: pages and summaries from the files of one run. Reads files, runs nothing."""

import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from avatarsim.errors import InvalidFile

if TYPE_CHECKING:
    from reports.deciding.verdict import Verdict
    from reports.page.index import Extras
    from reports.reading.load import Results

Found = TypeVar("Found")
PAGE, SUMMARY, JUNIT = "index.html", "summary.md", "junit.xml"


def write_report(run_dir: Path) -> tuple[str, ...]:
    """Write index.html, a page per scene, summary.md and junit.xml beside `run_dir`/results.json.

    Of other files of the run one that is damaged costs its scene or its section: the pages name it, and so does a sentence each
    that is returned. All pages are made before one of them is replaced. Raises InvalidFile when results.json is missing,
    truncated or of another schema; what stands in the folder then stays as it is.
    """
    from reports.deciding.verdict import verdict
    from reports.page.index import Extras
    from reports.reading.load import load
    from reports.sections import (
        broad_phase,
        closeness,
        convergence,
        effects,
        figure_7,
        growth,
        judge,
        law_map,
        narrow_phase,
        stability,
        table_2,
    )
    from reports.sections.sweep import points as sweep

    results = load(run_dir)
    damage = list[str]()

    def part(load: Callable[[Path], Found]) -> Found | None:
        """What a room of the run has; None where its file is damaged."""
        try:
            return load(run_dir)
        except InvalidFile as error:
            damage.append(str(error).replace(f"{run_dir}/", ""))
            return None

    extras = Extras(
        narrow=part(narrow_phase.load), broad=part(broad_phase.load), two=part(table_2.load), growth=part(growth.load),
        close=part(closeness.load), ablation=part(effects.load), figure_7=part(figure_7.load) or (), sweep=part(sweep.load),
        converging=part(convergence.load), law_map=part(law_map.load), steady=part(stability.load), judge=part(judge.load),
        # this one is written together with the pages
        files=frozenset({SUMMARY, *(entry.name for entry in run_dir.iterdir() if entry.is_file())}),
    )
    _replace(run_dir, _texts(run_dir, results, verdict(results), extras, damage))
    return tuple(damage)


def _texts(
    run_dir: Path, results: "Results", judged: "Verdict", extras: "Extras", damage: list[str],
) -> Iterator[tuple[str, str]]:
    """(path, text) of everything that is written; to `damage` comes what is left out of scenes."""
    from reports.page.index import layout, page
    from reports.page.scene_pages import scene_pages
    from reports.sections.page_paths import path_of
    from reports.summaries.junit import junit
    from reports.summaries.summary import summary

    laid_out = layout(results, judged)
    yield SUMMARY, summary(results, judged, extras.two, extras.close, damage, extras.sweep)
    yield JUNIT, junit(judged)
    courses, pictures, instants = {}, {}, {}
    for made in scene_pages(run_dir, results, judged, laid_out.by_scene()):
        courses[made.scene], pictures[made.scene], instants[made.scene] = made.charts, made.picture, made.instants
        damage += [f"{made.scene}: {said}" for said in made.damage]
        yield path_of(made.scene), made.text
    yield PAGE, page(results, judged, extras, courses, laid_out, pictures, damage, instants)


def _replace(run_dir: Path, texts: Iterable[tuple[str, str]]) -> None:
    """Write each text beside its place; once all are there, move them in, the page that leads to the others last."""
    halves: list[tuple[Path, Path]] = []
    try:
        for name, text in texts:
            place = run_dir / name
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
