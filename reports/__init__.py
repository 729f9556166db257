"""What we say: pages and summaries from the files of one run. Reads files, runs nothing."""

import os
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reports.load import Results
    from reports.page import Extras
    from reports.verdict import Verdict

PAGE, SUMMARY, JUNIT = "index.html", "summary.md", "junit.xml"


def write_report(run_dir: Path) -> None:
    """Write index.html, a page per scene, summary.md and junit.xml beside `run_dir`/results.json.

    All are made before one of them is replaced. Raises InvalidFile when results.json or another file of the run is missing,
    truncated or of another schema; what stands in the folder then stays as it is.
    """
    from reports import (
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
        sweep,
        table_2,
    )
    from reports.load import load
    from reports.page import Extras
    from reports.verdict import verdict

    results = load(run_dir)
    extras = Extras(*(room.load(run_dir) for room in (narrow_phase, broad_phase, table_2, growth, closeness, effects)))
    extras = replace(
        extras, figure_7=figure_7.load(run_dir), sweep=sweep.load(run_dir), converging=convergence.load(run_dir),
        law_map=law_map.load(run_dir), steady=stability.load(run_dir), judge=judge.load(run_dir),
    )
    _replace(run_dir, _texts(run_dir, results, verdict(results), extras))


def _texts(run_dir: Path, results: "Results", judged: "Verdict", extras: "Extras") -> Iterator[tuple[str, str]]:
    """(path, text) of everything that is written."""
    from reports.junit import junit
    from reports.page import layout, page
    from reports.page_paths import path_of
    from reports.scene_pages import scene_pages
    from reports.summary import summary

    laid_out = layout(results, judged)
    yield SUMMARY, summary(results, judged, extras.two, extras.close)
    yield JUNIT, junit(judged)
    courses, pictures = {}, {}
    for made in scene_pages(run_dir, results, judged, laid_out.by_scene()):
        courses[made.scene], pictures[made.scene] = made.charts, made.picture
        yield path_of(made.scene), made.text
    yield PAGE, page(results, judged, extras, courses, laid_out, pictures)


def _replace(run_dir: Path, texts: Iterable[tuple[str, str]]) -> None:
    """Write each text beside its place; once all are there, move them in, the page that leads to the others last."""
    halves: list[tuple[Path, Path]] = []
    try:
        for name, text in texts:
            place = run_dir / name
            place.parent.mkdir(exist_ok=True)
            half_written = place.with_name(f".{place.name}.part")
            halves.append((half_written, place))
            half_written.write_text(text, encoding="utf-8")
        for half_written, place in halves:
            os.replace(half_written, place)
    finally:
        for half_written, _ in halves:
            half_written.unlink(missing_ok=True)
