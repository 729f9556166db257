"""The section on the judge: what speaks against it comes first, and the page stays whole with and without its file."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from reports.sections import judge
from tests.reports.page.test_page import Tree

Json = dict[str, object]
Write = Callable[[object], Path]


def kind(name: str = "boxes", error: float = 3e-9, **counts: int) -> Json:
    told = {
        "kind": name, "pairs": 100, "overlapping": 75, "largest_error": error, "largest_depth_error": error, "unanswered": 0,
        "disagreements": 0, "overlapping_disagreements": 0, "judge_wrong": 0, "false_alarms": 0, "misses": 0, "at_the_bound": 0,
    }
    return told | counts


def fill(folder: Path, whole: Json) -> judge.Trust:
    told = {
        "schema_version": 1, "command": "python -m reference.judge_trust --pairs 100 --seed 5",
        "ended": "2026-01-02T03:04:05+00:00", "sources": "0123456789abcdef", "versions": {"coal": "3.0.3"}, "seed": 5,
        "bound_m": 1e-6, "promise_m": 1e-8, "same_m": 1e-6, "regimes": ["deep"], "all": whole,
        "kinds": [kind(), kind("<hulls>")],
    }
    (folder / judge.FILE).write_text(json.dumps(told))
    found = judge.load(folder)
    assert found is not None
    return found


def test_a_judge_that_keeps_its_promise(tmp_path: Path) -> None:
    assert judge.sentence(fill(tmp_path, kind("all"))) == (
        "The judge is right to 3.00 nm on each of 100 pairs whose exact depth or distance is known (75 overlap); "
        "0 false alarms and 0 missed overlaps at the bound of 1 µm."
    )


@pytest.mark.parametrize(("error", "said"), [(2e-6, "it errs by 2.00 µm on"), (float("nan"), "it passed over a pair on")])
def test_a_judge_that_does_not_is_said_first(tmp_path: Path, error: float, said: str) -> None:
    found = fill(tmp_path, kind("all", error, false_alarms=1, misses=2))
    assert not found.kept
    assert judge.sentence(found).startswith(f"The judge breaks its promise of 10.0 nm: {said}")
    assert "1 false alarm and 2 missed overlaps" in judge.sentence(found)


def test_the_second_opinion_is_told_with_what_it_did_not_answer(tmp_path: Path) -> None:
    assert judge.second(fill(tmp_path, kind("all"))).endswith("agrees to 1 µm on every pair that it answers.")
    told = judge.second(fill(tmp_path, kind("all", disagreements=20, overlapping_disagreements=5, judge_wrong=2, unanswered=1)))
    assert "differs by more than 1 µm on 20 pairs (20 %; 5 overlap)" in told
    assert "nearer to the exact answer on all but 2 of them" in told and "without an answer on 1 pair" in told


@pytest.mark.parametrize("text", ["{", '{"schema_version": 1}', '{"schema_version": 9}', "[]"])
def test_a_file_that_cannot_be_used_is_said_so(tmp_path: Path, text: str) -> None:
    assert judge.load(tmp_path) is None
    (tmp_path / judge.FILE).write_text(text)
    with pytest.raises(InvalidFile, match=judge.FILE):
        judge.load(tmp_path)


def test_the_page_has_the_section_and_stays_whole(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    write_report(folder)
    assert "The judge was not examined in this run: <code>python -m reference.judge_trust</code>" in page(folder)
    fill(folder, kind("all"))
    write_report(folder)
    tree = Tree()
    tree.feed(page(folder))
    assert tree.open == [] and len(tree.ids) == len(set(tree.ids)) and "judge" in tree.ids
    assert "--pairs 100 --seed 5" in page(folder) and "&lt;hulls&gt;" in page(folder)


def page(folder: Path) -> str:
    return (folder / "index.html").read_text()
