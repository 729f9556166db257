"""The section on single queries: there when its files are, losses first, and damaged files are said to be damaged."""

import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from reports.sections.narrow_phase import (
    ABOUT,
    ROWS,
    VERDICTS,
    call_costs,
    conclusion,
    fastest_right,
    inks,
    load,
    panels,
    start_up,
)
from tests.reports.page.test_page import Tree

Json = dict[str, object]
Write = Callable[[object], Path]

ROW = {"shape_a": "box", "shape_b": "hull", "regime": "deep", "mode": "cold", "engine": "ours", "library": "avatarsim",
       "per_call": "False", "us_p50": "2.0", "us_p25": "1.9", "us_p75": "2.1", "call_us": "nan", "max_error_m": "1e-15",
       "share_over_1e-06": "0", "share_over_0.0001": "0", "unanswered": "0", "judged": "200", "note": ""}
VERDICT = {"shape_a": "box", "shape_b": "hull", "regime": "deep", "mode": "cold", "allowed": "1", "ours_us": "2.0",
           "rival": "coal fast", "rival_us": "1.0", "ratio": "2.0", "ratio_placed": "0.95", "ours_called_us": "2.5",
           "rival_called": "coal fast",
           "rival_called_us": "1.5", "ratio_called": "1.667", "ours_right": "True", "held": "False"}
SAID = {
    "engines": [{"name": "coal fast", "what": "asks <coal>", "settings": {"gjk_variant": ["Nesterov", "it is faster"]}}],
    "absent": {"pybullet": "not measured: ImportError"}, "call_us": [{"engine": "coal fast", "mode": "cold", "us": 0.5}],
    "harness_us": {"clock": 0.01, "clock_and_loop": 0.03}, "provenance": {"cpus": 2}, "plan": {"pairs": 20},
    "start_up": {"compile_s": 12.0, "start_s": 1.5, "note": "", "compile_goal_s": 10.0, "start_goal_s": 2.0},
}


def table(path: Path, rows: list[dict[str, str]]) -> None:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def fill(folder: Path, **changed: str) -> Path:
    """Two cells cold, one coherent: the first lost, the others held; one library right, one wrong, one without an answer."""
    rows, verdicts = [], []
    for regime, mode, held in (("deep", "cold", "False"), ("apart", "cold", "True"), ("deep", "coherent", "True")):
        where = {"regime": regime, "mode": mode}
        rows += [ROW | where, ROW | where | {"engine": "coal fast", "library": "coal", "us_p50": "1.5"}]
        rows += [ROW | where | {"engine": "fcl", "library": "python-fcl", "us_p50": "0.5", "max_error_m": "0.001",
                                "share_over_1e-06": "0.5", "share_over_0.0001": "0.25"}]
        rows += [ROW | where | {"engine": "pb closest", "library": "pybullet", "us_p50": "nan", "max_error_m": "inf",
                                "share_over_1e-06": "1", "judged": "0", "note": "not measured: ImportError"}]
        verdicts.append(VERDICT | where | {"held": held} | ({"ratio": "0.9"} if held == "True" else {}))
    table(folder / ROWS, rows)
    table(folder / VERDICTS, [verdict | changed for verdict in verdicts])
    (folder / ABOUT).write_text(json.dumps(SAID))
    return folder


def test_no_files_no_section(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    assert load(folder) is None
    write_report(folder)
    assert 'id="queries"' not in (folder / "index.html").read_text()


def test_the_page_has_the_section_and_stays_whole(run_dir: Write, results: Json) -> None:
    folder = fill(run_dir(results))
    write_report(folder)
    text = (folder / "index.html").read_text(encoding="utf-8")
    tree = Tree()
    tree.feed(text)
    assert tree.open == [] and len(tree.ids) == len(set(tree.ids))
    assert {link[1:] for link in tree.links if link.startswith("#")} <= set(tree.ids)
    assert "asks &lt;coal&gt;" in text and "it is faster" in text and "not measured: ImportError" in text
    assert "Cold, we lose 1 of 2 cells: box-hull deep (2.00 of coal fast&#39;s time, allowed 1)." in text
    assert "Coherent, all 1 cell hold." in text
    assert "12.0 s; the goal of 10 s is missed" in text and "1.50 s; the goal of 2 s is held" in text


def test_lost_cells_stand_first_and_nan_is_nothing(tmp_path: Path) -> None:
    narrow = load(fill(tmp_path))
    assert narrow is not None
    assert [line.held for line in narrow.lines["cold"]] == [False, True]
    assert conclusion(narrow).startswith("Cold, we lose 1 of 2 cells")
    assert "computed within the time 2 hold, with a call from Python per query on both sides 0. Coherent" in conclusion(narrow)
    assert "coal fast 500 ns (cold)" in call_costs(narrow) and "30.0 ns per query" in call_costs(narrow)
    assert len(start_up(narrow)) == 2
    exact = {one.engine: one for one in narrow.exactness}
    assert (exact["fcl"].right, exact["fcl"].over, exact["fcl"].largest) == (0, (0.5, 0.25), 0.001)
    assert exact["ours"].right == 3 and "pb closest" not in exact


def test_a_chart_shows_only_who_is_right(tmp_path: Path) -> None:
    narrow = load(fill(tmp_path))
    assert narrow is not None
    assert fastest_right(narrow.lines["cold"][0], narrow) == {"avatarsim": 2.0, "coal": 1.5}
    cold, coherent = panels(narrow)
    assert cold.conclusion.startswith("In 1 of 2 cells ours takes more than the time of the fastest that is right")
    assert coherent.scene == "coherent"
    assert "box-hull deep" in cold.svg and "ours 2.00 µs, coal fast 1.00 µs" in cold.svg
    ink = inks(narrow)
    assert cold.svg.count(f'fill="{ink["avatarsim"].light}"') == 2 and f'fill="{ink["python-fcl"].light}"' not in cold.svg


@pytest.mark.parametrize("damage", [{"ratio": "fast"}, {"allowed": ""}])
def test_damaged_files_are_said_to_be(tmp_path: Path, damage: dict[str, str]) -> None:
    with pytest.raises(InvalidFile, match=ROWS):
        load(fill(tmp_path, **damage))


def test_half_a_benchmark_is_damaged(tmp_path: Path) -> None:
    (fill(tmp_path) / ABOUT).unlink()
    with pytest.raises(InvalidFile, match=ABOUT):
        load(tmp_path)


@pytest.mark.parametrize("changed", [
    {"engines": [{"name": "coal fast", "what": "asks", "settings": {"gjk_variant": ["Nesterov"]}}]},
    {"engines": [{"name": "coal fast", "what": "asks"}]}, {"engines": 3}, {"absent": ["pybullet"]},
])
def test_lists_that_are_too_short_cost_the_section_and_name_the_file(
    run_dir: Write, results: Json, changed: dict[str, object],
) -> None:
    folder = fill(run_dir(results))
    (folder / ABOUT).write_text(json.dumps(SAID | changed))
    damage = write_report(folder)
    text = (folder / "index.html").read_text(encoding="utf-8")
    assert len(damage) == 1 and ABOUT in damage[0] and f"Left out, since it cannot be used: {ROWS}" in text
    assert 'id="queries"' not in text and "Ranking</h2>" in text
