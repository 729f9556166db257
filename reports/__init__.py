"""What we say: pages and summaries from the files of one run. Reads files, runs nothing."""

import os
from pathlib import Path

PAGE, SUMMARY, JUNIT = "index.html", "summary.md", "junit.xml"


def write_report(run_dir: Path) -> None:
    """Write index.html, summary.md and junit.xml beside `run_dir`/results.json.

    All three are made before one of them is replaced. Raises InvalidFile when results.json is missing, truncated or of
    another schema; what stands in the folder then stays as it is.
    """
    from reports import broad_phase, closeness, effects, growth, narrow_phase, stability, table_2
    from reports.junit import junit
    from reports.load import load
    from reports.page import Extras, page
    from reports.summary import summary
    from reports.verdict import verdict

    results = load(run_dir)
    judged = verdict(results)
    rooms = (narrow_phase, broad_phase, table_2, growth, closeness, effects, stability)
    extras = Extras(*(room.load(run_dir) for room in rooms))
    whole = page(results, judged, extras)
    texts = {SUMMARY: summary(results, judged, extras.two, extras.close), JUNIT: junit(judged), PAGE: whole}
    for name, text in texts.items():
        half_written = run_dir / f".{name}.part"
        half_written.write_text(text, encoding="utf-8")
        os.replace(half_written, run_dir / name)
