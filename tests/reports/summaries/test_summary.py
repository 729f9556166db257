"""`summary.md` begins with the verdict, then what we lose; its tables hold whatever text a run brings."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from reports.deciding.verdict import verdict
from reports.reading.load import load
from reports.summaries.summary import summary
from reports.words.markdown import code, escaped

Json = dict[str, object]
Write = Callable[[object], Path]


def text_of(folder: Path) -> str:
    results = load(folder)
    return summary(results, verdict(results))


def test_losses_come_before_the_table(run_dir: Write, results: Json) -> None:
    text = text_of(run_dir(results))
    assert text.startswith("## FAILED: 1 of 3")
    parts = ("### Crashed", "### What we lose, worst first", "| ball_drop | **error of restitution**", "### All scenes",
             "Abacus 9")
    places = [text.index(part) for part in parts]
    assert places == sorted(places)
    table = text.split("### All scenes")[1]
    assert table.index("| ball_drop") < table.index("| hand_over_table") < table.index("| arm_wall")


def test_every_line_of_a_table_has_as_many_cells(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    text = text_of(run_dir(results | {"rows": [row | ({"note": "a|b\nc <i>"} if row["note"] else {}) for row in rows]}))
    for part in text.split("\n\n"):
        bars = {line.replace("\\|", "").count("|") for line in part.splitlines() if line.startswith("|")}
        assert len(bars) <= 1
    assert "a\\|b c &lt;i&gt;" in text


def test_an_empty_run_says_so(run_dir: Write, results: Json) -> None:
    empty = replace(load(run_dir(results)), rows=(), provenance={})
    text = summary(empty, verdict(empty))
    assert text.startswith("## EMPTY: No verdict") and "No row was measured" in text


def test_the_caveat_and_what_a_factor_against_zero_means_stand_beside_the_table(run_dir: Write, results: Json) -> None:
    text = text_of(run_dir(results))
    assert "avatar is kinematic" in text.split("\n\n")[1] and "Contact force and joint torque are not measured." in text
    table = text.split("### All scenes")[1]
    assert table.index("avatar is kinematic") < table.index("| scene |") < table.index("where the best is 0 there is none")


def test_a_median_time_says_how_it_was_taken(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    note = {"note": "3 x 200 frames, 30 warm-up frames; moving 40 us, resting 3 us"}
    timed = [row | note if row["metric"] == "frame_time_p50" else row for row in rows]
    assert "| 31.0 µs [3 x 200 frames; moving 40 µs, resting 3 µs] (best) |" in text_of(run_dir(results | {"rows": timed}))
    assert "| 31.0 µs (best) |" in text_of(run_dir(results))


def test_nothing_from_a_file_renders(run_dir: Write, results: Json) -> None:
    """A tag, a picture that is fetched, a link, code, emphasis, a heading: each stands there as text, wherever it comes from."""
    evil = "<img src=x>![p](https://a.b/c)`x`**b**|#"
    rows, series, provenance = results["rows"], results["series"], results["provenance"]
    assert isinstance(rows, list) and isinstance(series, dict) and isinstance(provenance, dict)
    changed = [
        row | {"scenario": evil, "engine": evil, "preset": evil, "unit": evil, "note": evil, "metric": row["metric"]}
        if row["engine"] != "avatarsim" else row | {"scenario": evil, "note": evil, "unit": evil} for row in rows
    ]
    found = results | {"rows": changed, "series": {}, "provenance": provenance | {"command": evil, evil: "x"}}
    text = text_of(run_dir(found))
    spans = re.compile(r"`[^`\n]*`")
    for line in text.splitlines():
        # within code nothing renders
        bare = spans.sub("", line)
        assert "<img" not in bare and "https://" not in bare
        assert not re.search(r"(?<!\\)[\[`]", bare.replace(" [", "")), line
        assert "**b**" not in bare and not (line.startswith("#") and evil[:4] in line)
    assert evil.replace("|", "\\|") not in text and "&lt;img src=x&gt;" in text


def test_escapes_of_markdown() -> None:
    assert escaped("a_b-1 of 2, 3 x 200 (best); \u00d71.5 < 2") == "a_b-1 of 2, 3 x 200 (best); \u00d71.5 &lt; 2"
    assert escaped("# [a](b)\n*c* `d` | e \\ ~~f~~") == r"\# \[a\](b) \*c\* \`d\` \| e \\ \~\~f\~\~"
    assert escaped("see https://a.b") == r"see https:\//a.b" and code("a`b\nc") == "`a'b c`"
