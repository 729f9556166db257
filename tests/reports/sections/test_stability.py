"""The section on stability: losses are counted, what is better than ours comes first, and the page stays whole."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from reports.sections import stability
from reports.sections.stability import DARKEST, panels, shade
from tests.reports.page.test_page import Tree

Json = dict[str, object]
Write = Callable[[object], Path]

HEAD = "case,run,kind,level,start,seed,user,dt,scale,far,state,frames,overlap,energy,bad,moved,seconds,note,form\n"


def row(run: str, kind: str, state: str = "survived", overlap: str = "1e-7", moved: str = "0.001", start: str = "0",
        form: str = "slice") -> str:
    return f"painleve,{run},{kind},x,{start},0,0,0.0166667,1,0,{state},36,{overlap},0,0,{moved},0.2,,{form}\n"


ROWS = HEAD + "".join([
    row("avatarsim/default", "plain", moved="0"), row("avatarsim/default", "start", moved="2e-5", start="1e-9"),
    row("avatarsim/default", "start", moved="4e-5", start="1e-7"),
    row("avatarsim/default", "size", "not a number", "", ""), row("avatarsim/default", "size", overlap="5e-7"),
    row("mujoco/tuned", "plain", overlap="0.003", moved="0"), row("mujoco/tuned", "start", overlap="0.003", moved="1e-8"),
    row("mujoco/tuned", "size", overlap="0.003"), row("mujoco/tuned", "size", "cannot say", "", ""),
])


def found(folder: Path, text: str = ROWS) -> stability.Stability:
    (folder / stability.ROWS).write_text(text)
    loaded = stability.load(folder)
    assert loaded is not None
    return loaded


def test_who_is_lost_counts_and_who_was_not_asked_does_not(tmp_path: Path) -> None:
    lines = {(line.kind, line.figure.name): line for line in stability.table(found(tmp_path))}
    assert lines["size", "trials lost"].values == {"avatarsim/default": 50.0, "mujoco/tuned": 0.0}
    assert lines["size", "not a number"].lost and not lines["size", "deepest overlap"].lost
    assert lines["start", "end moved, median"].values["avatarsim/default"] == pytest.approx(3e-5)
    assert ("plain", "end moved, most") not in lines


def test_rows_that_are_lost_come_first(tmp_path: Path) -> None:
    lines = stability.table(found(tmp_path))
    lost = [line.lost for line in lines]
    assert lost == sorted(lost, reverse=True)
    assert {(line.kind, line.figure.name) for line in lines if line.lost} == {
        ("start", "end moved, median"), ("start", "end moved, most"), ("size", "trials lost"), ("size", "not a number"),
    }


def test_the_conclusion_begins_with_what_is_lost(tmp_path: Path) -> None:
    said = stability.conclusion(found(tmp_path))
    assert said.startswith("On the same trials another engine stands better than ours: "
                           "fewer trials lost by mujoco/tuned (0 % ")
    assert "Hard cases do not all stay stable: avatarsim/default gets through 4 of 5 trials, 1 of them with a value" in said
    assert "from 1.00 nm to 20.0 µm, 100 nm to 40.0 µm." in said


def test_without_a_loss_it_says_so_and_answers(tmp_path: Path) -> None:
    text = HEAD + row("avatarsim/default", "plain", moved="0") + row("mujoco/tuned", "plain", overlap="0.003", moved="0")
    said = stability.conclusion(found(tmp_path, text))
    assert said.startswith("On the same trials no other engine stands better than ours in any of these figures. "
                           "Hard cases stay stable: ")
    assert "gets through 1 of 1 trial, none of them with a value that is no number" in said
    assert "overlaps by at most 100 nm as simulated (100 nm at size 1)" in said
    small = found(tmp_path, text.replace(",1,0,survived,36,1e-7", ",0.01,0,survived,36,1e-5"))
    assert "at most 100 nm as simulated (10.0 µm at size 1)" in stability.answer(small)
    alone = found(tmp_path, HEAD + row("mujoco/tuned", "plain"))
    assert stability.answer(alone).startswith("avatarsim/default was not tried")


def test_an_engine_stands_by_all_its_trials_and_its_spread_by_those_that_are_changed(tmp_path: Path) -> None:
    ours, theirs = stability.standings(found(tmp_path))
    assert (ours.run, ours.survived, ours.tried) == ("avatarsim/default", 4, 5)
    assert (theirs.run, theirs.survived, theirs.tried) == ("mujoco/tuned", 3, 3), "what was not asked does not count"
    assert ours.values["end moved, most"] == pytest.approx(1e-3) and theirs.values["deepest overlap"] == pytest.approx(3e-3)
    assert theirs.values["end moved, median"] == pytest.approx(0.5 * (1e-8 + 1e-3)), "the plain end is no part of it"


def test_a_slice_is_told_from_the_long_form(tmp_path: Path) -> None:
    assert stability.tried(found(tmp_path)).startswith("In this run, a slice: 1 case (painleve), each as it is and under ")
    long = found(tmp_path, HEAD + row("avatarsim/default", "start", form="long"))
    assert stability.tried(long) == "The long form, by make stability: 1 case (painleve), each as it is and under start (x)."
    before = found(tmp_path, HEAD.replace(",form", "") + row("avatarsim/default", "start").replace(",slice", ""))
    assert not before.is_slice


def test_a_cell_is_darker_the_worse_it_is() -> None:
    assert shade(0.0, 1.0, "m") == 0.0 == shade(math.nan, 1.0, "m") and shade(1.0, 1.0, "m") == DARKEST
    assert shade(1e-9, 1.0, "m") == pytest.approx(0.0) and 0.0 < shade(1e-3, 1.0, "m") < DARKEST
    assert shade(50.0, 80.0, "%") == pytest.approx(0.5 * DARKEST)
    values = {("overlap", "size", "a/b"): 1e-3, ("overlap", "start", "a/b"): 0.0}
    [panel] = panels(values, ("a/b",), ("size", "start"), {"overlap": "m", "energy": "J"})
    assert "1.00 mm" in panel.svg and panel.conclusion == "Worst: 1.00 mm, a/b, size."


def test_without_a_file_there_is_no_section_and_a_damaged_one_says_so(tmp_path: Path) -> None:
    assert stability.load(tmp_path) is None
    (tmp_path / stability.ROWS).write_text("case,run\nx,y\n")
    with pytest.raises(InvalidFile, match=stability.ROWS):
        stability.load(tmp_path)


def test_the_page_has_the_section_and_stays_whole(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    write_report(folder)
    assert "This run tried none of the hard cases: <code>make stability</code>" in (folder / "index.html").read_text()
    found(folder)
    write_report(folder)
    text = (folder / "index.html").read_text()
    tree = Tree()
    tree.feed(text)
    assert tree.open == [] and len(tree.ids) == len(set(tree.ids)) and "stability" in tree.ids
    assert "tried none of the hard cases" not in text and "In this run, a slice" in text
    assert {link[1:] for link in tree.links if link.startswith("#")} <= set(tree.ids)


def test_lost_trials_are_told_by_case_and_engine_with_their_reason(tmp_path: Path) -> None:
    lost = "painleve,mujoco/tuned,start,1e-05 m,0,0,0,0.01,1,0,lost,36,0.1,0,0,0.1,0.2,outside its region in 21 frames,slice\n"
    made = stability.lost_trials(found(tmp_path, ROWS + lost))
    assert [(one.case, one.run, one.lost, one.tried) for one in made] == [
        ("painleve", "avatarsim/default", 1, 5), ("painleve", "mujoco/tuned", 1, 4)]
    assert made[1].changes == ("start 1e-05 m",) and made[1].reasons == ("lost: outside its region in 21 frames",)
    assert stability.lost_trials(found(tmp_path, HEAD + row("avatarsim/default", "plain"))) == ()


def test_trials_lost_under_a_change_ours_cannot_be_asked_are_named(tmp_path: Path) -> None:
    lost = "heavy_on_light,mujoco/tuned,solver step,2 times,0,0,0,0.01,1,0,lost,36,0.2,0,0,0.1,0.2,outside in 26 frames,slice\n"
    step = row("avatarsim/default", "solver step", "cannot say", "", "")
    [_, one] = stability.lost_trials(found(tmp_path, ROWS + step + lost))
    assert (one.case, one.run, one.lost, one.tried) == ("heavy_on_light", "mujoco/tuned", 1, 1)
    assert one.changes == ("solver step 2 times",) and one.reasons == ("lost: outside in 26 frames",)


def test_the_largest_spread_of_ours_is_told_case_by_case(tmp_path: Path) -> None:
    ends = stability.worst_ends(found(tmp_path, COMMON))
    assert ends == ("painleve 248 mm (together, x)", "stack_ten 300 µm (together, x)")
    assert stability.section(found(tmp_path, COMMON))["stability_ends"] == "; ".join(ends)
    assert stability.worst_ends(found(tmp_path, HEAD + row("avatarsim/default", "plain"))) == ()


def test_to_survive_with_a_gain_of_energy_is_said_to_be_little(tmp_path: Path) -> None:
    gains = "painleve,avatarsim/paper,plain,x,0,0,0,0.0166667,1,0,survived,36,1e-7,491,0,0,0.2,,slice\n"
    said = stability.little_said(found(tmp_path, ROWS + gains))
    assert said == "To survive says little by itself: avatarsim/paper gains 491 J in a frame and survives all."
    assert stability.little_said(found(tmp_path)) == ""


def test_what_ours_cannot_be_asked_is_no_loss_and_counts_for_none(tmp_path: Path) -> None:
    step = row("avatarsim/default", "solver step", "cannot say", "", "") + row("mujoco/tuned", "solver step", "lost")
    made = found(tmp_path, ROWS + step)
    assert not any(line.lost for line in stability.table(made) if line.kind == "solver step")
    assert {line.run: line.tried for line in stability.standings(made)} == {"avatarsim/default": 5, "mujoco/tuned": 3}
    assert stability.step_said(made).startswith("Not in the table, since ours cannot be asked, is solver step (survived, worst "
                                                "figures): mujoco/tuned 0 of 1, overlap 100 nm, spread 1.00 mm")


def trial(case: str, run: str, kind: str, level: str, moved: float) -> str:
    return f"{case},{run},{kind},{level},0,0,0,0.0166667,1,0,survived,36,1e-7,0,0,{moved},0.2,,slice\n"


MOVED = {
    ("painleve", "together"): {"avatarsim/default": 0.248, "mujoco/tuned": 0.07, "mujoco/default": 0.087},
    ("stack_ten", "together"): {
        "avatarsim/default": 3e-4, "mujoco/tuned": 0.01, "mujoco/sleeping": 0.0226, "mujoco/default": 0.01},
    ("stack_ten", "start"): {"avatarsim/default": 3e-4, "mujoco/sleeping": 1e-4},
}
COMMON = HEAD + "".join(
    trial(case, run, kind, "x", moved) for (case, kind), runs in MOVED.items() for run, moved in runs.items())


def test_engines_are_compared_over_the_trials_that_both_have_and_all_that_are_ahead_are_named(tmp_path: Path) -> None:
    made = found(tmp_path, COMMON)
    assert stability.behind(made)[-1:] == (
        "less spread at most by mujoco/tuned (70.0 mm in painleve against 248 mm in painleve, over 2 trials that both survived), "
        "mujoco/default (87.0 mm in painleve against 248 mm in painleve, over 2 trials that both survived)",
    ), "sleeping has no trial of painleve and is worse in its own"
    assert stability.behind_by_kind(made)[-1:] == (
        "start: less spread at most by mujoco/sleeping (100 µm in stack_ten against 300 µm in stack_ten, over 1 trial that both "
        "survived, of 1 of 2 cases)",)
    assert "248 mm at most (painleve)." in stability.answer(made)


def test_values_are_compared_over_trials_that_both_survived(tmp_path: Path) -> None:
    lost = "painleve,mujoco/default,together,x,0,0,0,0.0166667,1,0,survived"
    assert COMMON.count(lost) == 1
    said = stability.behind(found(tmp_path, COMMON.replace(lost, lost.replace("survived", "lost"))))[-1]
    assert "mujoco/default" not in said, "its end of a trial that it lost is no end that ours is behind of"
    # theirs is largest in another case than ours, and both are named
    apart = COMMON.replace("mujoco/tuned,together,x,0,0,0,0.0166667,1,0,survived,36,1e-7,0,0,0.01,",
                           "mujoco/tuned,together,x,0,0,0,0.0166667,1,0,survived,36,1e-7,0,0,0.09,")
    said = stability.behind(found(tmp_path, apart))[-1]
    assert "mujoco/tuned (90.0 mm in stack_ten against 248 mm in painleve, over 2 trials that both survived)" in said


def test_cases_that_an_engine_was_not_tried_in_stand_beside_its_count(tmp_path: Path) -> None:
    told = {line.run: line.told(2) for line in stability.standings(found(tmp_path, COMMON))}
    assert told["mujoco/sleeping"] == "2 of 2 (1 of 2 cases)" and told["mujoco/tuned"] == "2 of 2"
