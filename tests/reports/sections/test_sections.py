"""The sections that a run has only after a benchmark or a later question: there when their files are, losses named first."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from reports.__main__ import main
from reports.sections import closeness, growth, table_2
from reports.sections.table_2 import panels
from reports.summaries import summary
from runfiles.csv_rows import times
from tests.reports.page.test_page import Tree

Json = dict[str, object]
Write = Callable[[object], Path]

TABLE = (
    "scene,run,frames,timed,ms,p50,p99,joints,iterations,pairs,queries,ik_share,collision_share,posing_share,us_per_joint,"
    "us_per_iteration,us_per_pair,us_per_query,overlap\n"
    "two_arms,printed in the paper,1496,1496,14.63,,,16,3,3,,12.7,17.4,,,,,,\n"
    "two_arms,avatarsim/default,600,360,0.0146,{p50},{p99},4.3,2.1,2.1,,12,38,15,,0.8,2.7,1,0\n"
    "two_arms,mujoco/tuned,600,360,0.57,{tuned},600,,,,,,,,,,,,5e-6\n"
    "two_arms,mujoco/default,600,360,0.2,60,300,,,,,,,,,,,,0.0009\n"
)
NEAR = (
    "scenario,frames,lost,offset,nearest_offset,angle,nearest_angle,distance,nearest_distance,downhill_distance,near_offset,near_angle\n"
    "arm_in_corner,12,1,0.03,0.02,0.1,0.1,0.05,0.04,0.05,1,1\n"
    "two_arms,12,0,0.03,0.01,0.1,0.0,0.05,0.04,0.05,1,1\n"
    "squeeze,12,0,0.03,0.03,0.5,0.2,0.05,0.04,0.05,1,0\n"
)
BESIDE = (
    "other,scenario,frames,counted,offset,their_offset,angle,their_angle,body,their_body,nearer_offset,nearer_angle,nearer_body,"
    "known_offset,known_angle\n"
    "mujoco.tuned,two_arms,600,599,0.03,0.01,1.5,2.5,0.02,0.03,theirs,ours,ours,,\n"
    "mujoco.tuned,mocap_roll,151,151,0.02,0.015,3.5,2.5,0.03,0.02,theirs,theirs,theirs,its spring; its luck,\n"
    "mujoco.tuned,squeeze,150,0,,,,,,,-,-,-,,\n"
)
GROWTH = "grows,mode,size,links,run,p50,p95,note\n" + "".join(
    f"avatars,apart,{size},{15 * size},{run},{p50},{2 * p50},3 repeats\n"
    for run, power, base in (("avatarsim/default", 2, 4.0), ("avatarsim/paper", 1, 10.0)) for size in (1, 3, 10)
    for p50 in (base * size**power,)
) + "avatars,apart,30,450,mujoco/tuned,,,it fell over\n"


def two(folder: Path, p50: float = 14.0, p99: float = 40.0, tuned: float = 500.0) -> table_2.Table2:
    (folder / table_2.TABLE).write_text(TABLE.format(p50=p50, p99=p99, tuned=tuned))
    found = table_2.load(folder)
    assert found is not None
    return found


def test_nothing_without_files(tmp_path: Path) -> None:
    assert table_2.load(tmp_path) is None and growth.load(tmp_path) is None and closeness.load(tmp_path) is None


@pytest.mark.parametrize("room", [(table_2, table_2.TABLE), (growth, growth.ROWS), (closeness, closeness.NEAREST),
                                  (closeness, closeness.BESIDE)])
def test_a_damaged_file_is_said_to_be_damaged(tmp_path: Path, room: tuple[object, str]) -> None:
    (tmp_path / room[1]).write_text("scene,run\ntwo_arms,x\n")
    with pytest.raises(InvalidFile, match=room[1]):
        room[0].load(tmp_path)  # type: ignore[attr-defined]


@pytest.mark.parametrize("content", [b"scene,run\ntwo_arms,x\n", b"\xff\xfe", b'"' + b"x" * 200_000])
def test_damaged_tables_cost_their_sections_and_not_the_page(
    run_dir: Write, results: Json, content: bytes, capsys: pytest.CaptureFixture[str],
) -> None:
    folder = run_dir(results)
    names = (table_2.TABLE, growth.ROWS, closeness.NEAREST, "sweep.csv", "judge.json", "ablation.json", "law_map.csv",
             "stability.csv", "broad_phase.csv", "narrow_phase.csv", "figure_7.csv", "convergence.csv")
    for name in names:
        (folder / name).write_bytes(content)
    assert main(["write", str(folder)]) == 2
    said = capsys.readouterr()
    text = (folder / "index.html").read_text(encoding="utf-8")
    for name in names:
        # the narrow phase has three files, and any of them is named
        named = name.removesuffix(".csv")
        assert f"left out, since it cannot be used: {named}" in said.err
        assert f"Left out, since it cannot be used: {named}" in text
    assert said.out.strip() == str(folder / "index.html") and "Ranking</h2>" in text


def test_ratios_of_nothing() -> None:
    assert times(0.0, 0.0) == 1.0 and times(1.0, 0.0) == math.inf and math.isnan(times(math.nan, 1.0))


def test_budget_and_lead_are_judged(tmp_path: Path) -> None:
    good, late = two(tmp_path), two(tmp_path, p99=101.0)
    assert table_2.budget(good).endswith("Held in all 1 scene.")
    assert "Over it: two_arms (p50 14.0 µs, p99 101 µs)." in table_2.budget(late)
    unknown = table_2.budget(two(tmp_path, p99=math.nan))
    assert "Too few frames were timed for a p99 in two_arms." in unknown and "Over it" not in unknown
    assert "Over it: two_arms" in table_2.budget(two(tmp_path, p50=math.nan))
    assert "10 µm: 35.7 times (mujoco/tuned in two_arms; promised 10, kept)" in table_2.ratios(good)
    # the default preset leaves 0.9 mm and is 4.3 times as slow
    assert "1 mm: 4.29 times (mujoco/default in two_arms; promised 3, kept)" in table_2.ratios(good)
    assert "10 µm: 7.14 times (mujoco/tuned in two_arms; promised 10, missed)" in table_2.ratios(two(tmp_path, tuned=100.0))


def test_spikes_are_found_where_contact_begins() -> None:
    iterations = np.r_[np.ones(20), 4 * np.ones(20), np.ones(20), 3 * np.ones(20)]
    us = np.r_[10 * np.ones(20), 50, 40, 20 * np.ones(18), 10 * np.ones(20), 30, 30, 20 * np.ones(18)]
    assert table_2.spikes(us, iterations) == (2, 10.0, 40.0, 20.0)
    assert "contact begins 2 times" in table_2.spike_sentence("x", us, iterations) and "falls, to 20.0 µs" in (
        table_2.spike_sentence("x", us, iterations))
    assert "does not fall" in table_2.spike_sentence("x", iterations * 10.0, iterations)
    assert table_2.spike_sentence("x", us, np.ones(80)) == "x: no contact begins in these frames."


def test_figure_8_has_a_panel_per_method(tmp_path: Path) -> None:
    frames = [(k + 1, k % 40 > 20) for k in range(80)]
    lines = "".join(f"{run},{frame},{10 + 20 * busy},{1 + busy}\n" for run in table_2.METHODS for frame, busy in frames)
    (tmp_path / table_2.TRACE).write_text("run,frame,us,iterations\n" + lines)
    made = panels(two(tmp_path))
    assert [panel.scene for panel in made] == list(table_2.METHODS)
    assert "contact begins 2 times" in made[0].conclusion and "µs per frame" in made[0].svg


def test_growth_says_where_ours_is_steep_and_where_it_is_slower(tmp_path: Path) -> None:
    (tmp_path / growth.ROWS).write_text(GROWTH)
    found = growth.load(tmp_path)
    assert found is not None
    said = growth.conclusion(found)
    steep = "avatars, apart (power 2.00 over all, 2.00 at its steepest)"
    assert said.startswith(f"Faster than in proportion, ours grows with {steep}.")
    assert "Faster than ours: avatarsim/paper with 3 avatars, apart, avatarsim/paper with 10 avatars, apart." in said
    [panel] = growth.panels(found)
    assert panel.scene == "avatars, apart" and "avatarsim/default grows with the power 2.00" in panel.conclusion


def test_closeness_names_what_is_beyond_and_who_is_nearer(tmp_path: Path) -> None:
    (tmp_path / closeness.NEAREST).write_text(NEAR)
    (tmp_path / closeness.BESIDE).write_text(BESIDE)
    found = closeness.load(tmp_path)
    assert found is not None and [line.scenario for line in found.near] == ["two_arms", "squeeze", "arm_in_corner"]
    assert closeness.near_sentence(found.near) == (
        "Offset and angle are within 2 times in 1 of 3 scenes. Beyond: two_arms (offset ×3.00, angle against 0), "
        "squeeze (offset ×1.00, angle ×2.50)."
    )
    assert closeness.pair_sentence(found.pairs) == (
        "In offset, mujoco/tuned is nearer in 2 scenes: two_arms, mocap_roll; ours in 0. In angle, mujoco/tuned is nearer in "
        "1 scene: mocap_roll; ours in 1. In the distance of all of the body, mujoco/tuned is nearer in 1 scene: mocap_roll; "
        "ours in 1."
    )
    assert closeness.pair_notes(found.pairs) == ("mocap_roll, offset: its spring; its luck.",)


def test_page_and_summary_have_the_sections_and_stay_whole(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    write_report(folder)
    names = ("closeness", "table-2", "growth")
    before = (folder / "index.html").read_text()
    assert not any(f'id="{name}"' in before for name in names)
    two(folder)
    for name, text in ((closeness.NEAREST, NEAR), (closeness.BESIDE, BESIDE), (growth.ROWS, GROWTH)):
        (folder / name).write_text(text)
    write_report(folder)
    text = (folder / "index.html").read_text()
    tree = Tree()
    tree.feed(text)
    assert tree.open == [] and len(tree.ids) == len(set(tree.ids)) and set(names) <= set(tree.ids)
    assert {link[1:] for link in tree.links if link.startswith("#")} <= set(tree.ids)
    assert "mocap_roll, offset: its spring; its luck." in text and "11 of 12" in text and "printed in the paper" in text
    assert "nan" not in text.split('id="closeness"')[1].split('id="settings"')[0].lower().replace("provenance", "")
    told = (folder / "summary.md").read_text()
    assert "| two_arms | printed in the paper | 1496 | 14.63 | 16.0 |" in told
    assert "### Beside the nearest free posture" in told and "beside mujoco/tuned" in told


@pytest.mark.parametrize("name", ["markdown", "near_sentence"])
def test_the_summary_leaves_out_what_cannot_be_told(
    run_dir: Write, results: Json, monkeypatch: pytest.MonkeyPatch, name: str,
) -> None:
    def fails(found: object) -> str:
        raise ValueError("cannot convert float NaN to integer")

    folder = run_dir(results)
    two(folder)
    (folder / closeness.NEAREST).write_text(NEAR)
    monkeypatch.setattr(summary, name, fails)
    [said] = write_report(folder)
    told = (folder / "summary.md").read_text()
    assert said.startswith("table_2.csv, figure_8.csv: " if name == "markdown" else "nearest_free_scenes.csv, beside.csv: ")
    assert ("### Table 2" in told) == (name != "markdown") and ("nearest free posture" in told) == (name == "markdown")
    assert f"Left out, since it cannot be used: {said}" in (folder / "index.html").read_text()
