"""Sweep and prune in the report: there when its file is, what is not flat is named first, and a damaged file is said to be."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from reports.sections.broad_phase import ROWS, BroadPhase, conclusion, inks, load, panels, section
from tests.reports.page.test_page import Tree

Json = dict[str, object]
Write = Callable[[object], Path]

HEAD = "layout,motion,objects,kernel,us_per_object_p50,bytes_per_object,near_pairs,found_is_twin\n"


def fill(folder: Path, *lines: str) -> BroadPhase:
    (folder / ROWS).write_text(HEAD + "\n".join(lines) + "\n")
    found = load(folder)
    assert found is not None
    return found


def rows(time: float, memory: float = 250.0, motion: str = "all slow", kernel: str = "sweep and prune", right: bool = True):
    return (f"cube,{motion},20000,{kernel},{0.01 * time},{memory},5,{right}", f"cube,{motion},20,{kernel},0.01,200,5,True")


def test_nothing_when_the_benchmark_was_not_run(tmp_path: Path) -> None:
    assert load(tmp_path) is None
    assert conclusion(BroadPhase(())) == "Nothing was measured."


def test_flat_growth_is_said_with_its_figures(tmp_path: Path) -> None:
    said = conclusion(fill(tmp_path, *rows(1.5), *rows(9.0, motion="all fast"), *rows(99.0, kernel="one axis")))
    assert said == (
        "Per object, from 20 to 20,000 objects, time grows by 1.50 at most (cube, all slow) and memory by 1.25: flat within 2 in "
        "all 1 case."
    )


@pytest.mark.parametrize(("time", "memory"), [(2.1, 250.0), (0.4, 250.0), (1.0, 500.0), (0.0, 250.0)])
def test_growth_that_is_not_flat_is_named(tmp_path: Path, time: float, memory: float) -> None:
    said = conclusion(fill(tmp_path, *rows(time, memory), *rows(1.0, motion="none")))
    start = "Per object, from 20 to 20,000 objects, 1 of 2 cases grow by more than 2: cube, all slow (time "
    assert said.startswith(start + ("×" if time else "against 0"))


def test_wrong_pairs_come_first(tmp_path: Path) -> None:
    said = conclusion(fill(tmp_path, *rows(1.0, right=False)))
    assert said.startswith("Other pairs than by trying all: cube, all slow, sweep and prune.")


@pytest.mark.parametrize("text", ["", "layout,motion\ncube,none\n", HEAD + "cube,none,many,x,1,1,1,True\n"])
def test_a_damaged_file_is_said_to_be_damaged(tmp_path: Path, text: str) -> None:
    (tmp_path / ROWS).write_text(text)
    if text:
        with pytest.raises(InvalidFile, match="broad_phase.csv"):
            load(tmp_path)
    else:
        assert load(tmp_path) == BroadPhase(())


def test_a_panel_per_layout_with_words_and_a_stroke_per_line(tmp_path: Path) -> None:
    plane = tuple(row.replace("cube", "plane") for row in rows(3.0))
    broad = fill(tmp_path, *rows(1.5), *rows(1.0, motion="none"), *rows(90.0, kernel="one axis"), *plane)
    made = panels(broad)
    assert [panel.scene for panel in made] == ["cube", "plane", "memory"]
    assert made[2].conclusion.startswith("Largest memory per object over smallest, 2 allowed: ×")
    assert re.findall(r">(\d+ k?B)<", made[2].svg)
    assert made[0].conclusion == "Largest time per object over smallest, 2 allowed: all slow ×1.50; none ×1.00."
    assert "one axis, all slow 10.0 ns at 20, 900 ns at 20,000" in made[0].svg
    # the labels of the axis: no power of ten looks like another
    assert re.findall(r">(\S+ [nµ]s)<", made[0].svg) == ["10 ns", "100 ns", "1 µs"]
    for name, stroke in inks(broad).items():
        assert stroke.light in made[0].svg, name
    assert set(section(broad)) == {"broad_conclusion", "broad_panels", "broad_inks"}


def test_the_page_has_the_section_and_stays_whole(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    write_report(folder)
    assert 'id="many"' not in (folder / "index.html").read_text()
    fill(folder, *rows(1.5), *rows(9.0, motion="all fast"), *rows(99.0, kernel="one axis"))
    write_report(folder)
    text = (folder / "index.html").read_text()
    tree = Tree()
    tree.feed(text)
    assert tree.open == [] and len(tree.ids) == len(set(tree.ids))
    assert {link[1:] for link in tree.links if link.startswith("#")} <= set(tree.ids)
    assert 'id="many"' in text and "from 20 to 20,000 objects" in text and "one axis, all slow" in text
