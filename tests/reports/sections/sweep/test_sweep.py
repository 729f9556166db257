"""The sections of the sweep, of convergence and of the map: from files alone, what is lost first."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from reports.deciding.alike import Basis
from reports.reading.load import load
from reports.sections import convergence, law_map
from reports.sections import law_map as law_map_chart
from reports.sections.sweep import chart as sweep_chart
from reports.sections.sweep import points as sweep
from reports.sections.sweep.elsewhere import elsewhere
from tests.reports.conftest import row
from tests.reports.page.test_page import Tree

Json = dict[str, object]
Write = Callable[[object], Path]

HEAD = "scenario,engine,setting,metric,unit,error,p50,p99,state,front,reached,note\n"


def line(scene: str, run: str, error: float | str, p50: float | str, state: str = "measured", front: str = "",
         metric: str = "residual_overlap_max") -> str:
    engine, setting = run.split("/", 1)
    return f"{scene},{engine},{setting},{metric},m,{error},{p50},{p50},{state},{front},1e-06,\n"


WON = (
    line("wall", "avatarsim/default", 0, 10, front="all") + line("wall", "mujoco/tuned dt=1/60", 2e-3, 8, front="all")
    + line("wall", "mujoco/tuned", 5e-4, 35, front="own") + line("wall", "pybullet/tuned", 9e-6, 150, front="own")
    + line("wall", "pybullet/default", "", "", "crashed")
)
SHORT = line("stack", "avatarsim/default", 0, 10, front="all") + line("stack", "pybullet/tuned", 9e-6, 50, front="own")
BEATEN = (
    line("drop", "avatarsim/default", 2e-6, 10, metric="apex_error_max")
    + line("drop", "mujoco/tuned", 1e-6, 9, front="all", metric="apex_error_max")
)
THROUGH = line("thin", "avatarsim/default", 0, 10, front="all") + line("thin", "mujoco/tuned", 0, 5, "wrong-side")
CONVERGENCE = "scenario,engine,preset,rate,off,off_max,overlap,beyond,from_ours,note\n" + "".join(
    f"wall,{engine},{preset},{rate},{off},{off},{overlap},0,{apart},\n"
    for engine, preset, scale, overlap, apart in (("avatarsim", "default", 0.1, 0, 0), ("mujoco", "tuned", 1.0, 1e-3, 0.01))
    for rate, off in ((60, scale * 1e-2), (240, scale * 2.5e-3), (960, scale * 6.25e-4), (7680, 0))
) + "wall,pybullet,default,60,,,,,,it died\nwall,pybullet,default,7680,,,,,,it died\n"
MAP = "law,shape,engine,preset,rate,asked,got,low,high,note\n" + "".join(
    f"restitution,sphere,{engine},{preset},{rate},{asked},{asked + off},{asked - abs(off)},{asked + abs(off)},\n"
    for engine, preset, off in (("avatarsim", "default", 1e-8), ("mujoco", "tuned", 0.04)) for rate in (60, 240)
    for asked in (0.5, 1.0)
) + "restitution,capsule,mujoco,default,60,0.5,,,,4 of 4 bodies gave no figure\n"


def loaded(folder: Path, text: str) -> sweep.Sweep:
    (folder / sweep.ROWS).write_text(HEAD + text)
    found = sweep.load(folder)
    assert found is not None
    return found


def test_nothing_without_files(tmp_path: Path) -> None:
    assert sweep.load(tmp_path) is None and convergence.load(tmp_path) is None and law_map.load(tmp_path) is None


@pytest.mark.parametrize("room", [sweep, convergence, law_map])
def test_a_damaged_file_is_said_to_be_damaged(tmp_path: Path, room: object) -> None:
    name: str = room.ROWS  # type: ignore[attr-defined]
    (tmp_path / name).write_text("scenario,engine\nwall,x\n")
    with pytest.raises(InvalidFile, match=name):
        room.load(tmp_path)  # type: ignore[attr-defined]


def test_ratios_that_hold_are_said_with_where_they_are_closest(tmp_path: Path) -> None:
    found = loaded(tmp_path, WON)
    rivalry = found.rivalries[0]
    assert not rivalry.lost and rivalry.said == "holds" and rivalry.better == ()
    ten, three = rivalry.ratios
    assert ten is not None and three is not None and ten[1] == pytest.approx(15.0) and three[1] == pytest.approx(3.5)
    said = sweep.conclusion(found)
    assert "of other engines is both as fast and as accurate as ours, in 1 scene" in said
    assert "×15.0 where it is closest (wall, deepest overlap shown alone, pybullet/tuned)" in said and "×3.50" in said


def test_what_fails_is_said_and_stands_first(tmp_path: Path) -> None:
    found = loaded(tmp_path, WON + SHORT + BEATEN)
    assert [r.scenario for r in found.rivalries] == ["stack", "drop", "wall"]
    stack, drop, _ = found.rivalries
    assert "takes ×5.00, not ×10" in stack.said and drop.said == "as fast and as accurate: mujoco/tuned" and drop.ratios == ()
    said = sweep.conclusion(found)
    assert said.startswith("Taken for one kind of error alone, where the cases above and the table below count all errors of a "
                           "scene at once, without an avatar another engine is both as fast and as accurate as ours in drop "
                           "(error of the bounce height alone: mujoco/tuned).")
    assert ("10 times faster than any measured that leaves at most 10 µm in stack (deepest overlap shown alone: ×5.00, "
            "pybullet/tuned)") in said


def test_what_went_through_the_wall_beats_nothing(tmp_path: Path) -> None:
    found = loaded(tmp_path, THROUGH)
    assert not found.rivalries[0].lost and found.rivalries[0].spoilt[0].run == "mujoco/tuned"
    assert "at most 10 µm is reached by none of " in sweep.conclusion(found)


def test_without_our_own_figure_nothing_holds(tmp_path: Path) -> None:
    found = loaded(tmp_path, line("wall", "mujoco/tuned", 0, 5) + line("wall", "avatarsim/default", "", 5, "crashed"))
    assert found.rivalries[0].lost and sweep.conclusion(found).startswith("Ours was not measured in a scene")
    both = loaded(tmp_path, WON + line("stack", "mujoco/tuned", 0, 5))
    assert sweep.conclusion(both).endswith("Ours was not measured in stack.")


def test_a_panel_per_scene_and_the_other_errors_apart(tmp_path: Path) -> None:
    second = line("wall", "avatarsim/default", 1e-3, 10, metric="tracker_offset_rms_free")
    firsts, others = sweep_chart.panels(loaded(tmp_path, WON + SHORT + BEATEN + second))
    assert [panel.title for panel in firsts] == [
        "wall: deepest overlap shown", "stack: deepest overlap shown", "drop: error of the bounce height"]
    assert [panel.title for panel in others] == ["wall: offset from the user while nothing is in the way"]
    assert all(panel.svg.startswith("<svg role=") and "stroke-dasharray" in panel.svg for panel in firsts)
    assert all("60 Hz" in panel.svg and ">90<" in panel.svg for panel in firsts)
    assert "Crosses: pybullet/default (crashed)." in firsts[0].conclusion
    assert "avatarsim 10.0 µs (default, 1), mujoco 35.0 µs (tuned, " in firsts[0].conclusion
    assert sweep_chart.panels(loaded(tmp_path, line("wall", "avatarsim/default", 0, ""))) == ([], [])


def test_the_heading_of_what_single_errors_say_counts_what_is_lost(tmp_path: Path) -> None:
    assert sweep.alone_heading(loaded(tmp_path, WON + SHORT + BEATEN)).endswith("is as fast and as accurate in 1 of 3")


def test_points_have_labels_and_tooltips_with_the_options(tmp_path: Path) -> None:
    (tmp_path / sweep.ROWS).write_text(
        HEAD.replace("note\n", "note,base,options,repeats,frames\n")
        + "wall,avatarsim,default,residual_overlap_max,m,0,10,,measured,all,1e-06,,default,--engine avatarsim,3,180\n"
        + "wall,mujoco,tuned dt=1/60,residual_overlap_max,m,0.002,8,,measured,all,1e-06,,tuned,mujoco.x = {dt = 0.1},1,300\n"
        + "wall,mujoco,tuned dt=1/120,residual_overlap_max,m,0,8,,wrong-side,,1e-06,,tuned,,1,300\n"
    )
    found = sweep.load(tmp_path)
    assert found is not None
    (panel,), _ = sweep_chart.panels(found)
    assert "<title>avatarsim/default: 0, 10.0 µs per frame (median, 3 × 180 frames)\n--engine avatarsim</title>" in panel.svg
    assert "<title>mujoco/tuned dt=1/60: 2.00 mm, 8.00 µs per frame (median, 1 × 300 frames)\nmujoco.x = {dt = 0.1}" in panel.svg
    assert ">1/60</text>" in panel.svg and ">default</text>" in panel.svg and "; wrong-side</title>" in panel.svg
    assert list(sweep_chart.inks(found)) == ["avatarsim/default", "mujoco/tuned"]


def test_all_that_is_drawn_stands_as_text_too_and_tooltips_have_the_engines_own_words(tmp_path: Path) -> None:
    (tmp_path / sweep.ROWS).write_text(
        HEAD.replace("note\n", "note,base,options,repeats,frames,settable,p95,rests,moving,at_rest,sleeps,step\n")
        + "wall,mujoco,tuned iterations=9,residual_overlap_max,m,0.002,8,,measured,,1e-06,,tuned,row,1,300,opt.iterations = 9,"
        + "9,,,,1,0.0167\n"
        + "wall,mujoco,default,residual_overlap_max,m,,8,,cannot-say,,1e-06,no words,default,,1,300,,,,,,,\n"
    )
    found = sweep.load(tmp_path)
    assert found is not None and found.points[0].sleeps and not found.points[1].sleeps and found.points[0].p95 == 9.0
    (panel,), _ = sweep_chart.panels(found)
    assert panel.points == (("mujoco/tuned iterations=9", "2.00 mm", "8.00 µs"),) and "Crosses" not in panel.conclusion
    assert "95th percentile 9.00 µs): " not in panel.svg and "opt.iterations = 9</title>" in panel.svg


def test_the_budget_of_90_hertz_is_said_as_it_is(tmp_path: Path) -> None:
    said = sweep_chart.budget_sentence(loaded(tmp_path, WON))
    assert "In the median all settings" in said and "the slowest 150 µs, wall pybullet/tuned" in said
    slow = loaded(tmp_path, WON + line("wall", "m/slow", 0, 11200, front="own"))
    assert sweep_chart.budget_sentence(slow).endswith("a frame at 90 Hz: wall m/slow.")
    assert sweep_chart.budget_sentence(loaded(tmp_path, line("wall", "m/a", 0, ""))) == ""


def test_a_family_is_drawn_along_the_settings_that_no_other_of_it_beats(tmp_path: Path) -> None:
    points = loaded(tmp_path, line("wall", "m/a 1", 1e-2, 1) + line("wall", "m/a 2", 1e-2, 2) + line("wall", "m/a 3", 1e-3, 3)
                    + line("wall", "m/a 4", 5e-3, 4) + line("wall", "m/a 5", 1e-4, 3)).points
    assert [p.setting for p in sweep_chart.family_front(points)] == ["a 1", "a 5"]


def test_the_page_says_which_sweep_ran_and_what_did_not_fit(tmp_path: Path) -> None:
    assert "does not say" in sweep_chart.protocol(loaded(tmp_path, WON))
    about = {"form": "short", "seconds": 41.5, "budget": 55.0, "settings": 7, "reused": 2, "left": ["wall: m/a b", "wall: m/c"],
             "late": ["stack"], "repeats": 3, "once": 300}
    (tmp_path / sweep.ABOUT).write_text(json.dumps(about))
    short = loaded(tmp_path, WON)
    said = sweep_chart.protocol(short)
    assert "a short sweep of 41.5 s: 7 cells" in said and "2 further cells did not fit into the 55 s" in said and "stack." in said
    assert "3 of them, in the sweep 1 where a scene has 300 frames or more" in said
    assert sweep_chart.left_out(short) == [("wall", "m/a b, m/c")]
    (tmp_path / sweep.ABOUT).write_text(json.dumps({"form": "long", "settings": 9, "kept": 4}))
    assert "9 cells, of which 4 were kept" in sweep_chart.protocol(loaded(tmp_path, WON))
    (tmp_path / sweep.ABOUT).write_text("[")
    with pytest.raises(InvalidFile, match=r"sweep\.json"):
        sweep.load(tmp_path)


def test_who_is_consistent_and_who_is_right(tmp_path: Path) -> None:
    (tmp_path / convergence.ROWS).write_text(CONVERGENCE)
    found = convergence.load(tmp_path)
    assert found is not None and found.rates == (60, 240, 960)
    by_run = {course.run: course for course in found.courses}
    ours, theirs, dead = (by_run[run] for run in ("avatarsim/default", "mujoco/tuned", "pybullet/default"))
    assert ours.said == "consistent, right" and theirs.said == "consistent, not right" and dead.said == "no finest run: it died"
    assert ours.order == pytest.approx(1.0) and math.isnan(dead.order) and convergence.order_words(dead) == "—"
    said = convergence.conclusion(found)
    assert "Ours approaches its own finest run in 1 of 1 scene." in said and "do not help: mujoco/tuned in wall" in said


def test_the_map_says_where_ours_misses(tmp_path: Path) -> None:
    (tmp_path / law_map.ROWS).write_text(MAP)
    found = law_map.load(tmp_path)
    assert found is not None and found.asked("restitution") == (0.5, 1.0) and found.shapes == ("sphere", "capsule")
    said = law_map.conclusion(found)
    assert said.startswith("Ours gives what is asked to 1.0·10⁻⁸") and "mujoco/tuned by up to 0.04" in said
    assert "Bodies without a figure (never hit, or through the floor): mujoco/default (capsule, 1/60 s)." in said
    panels = law_map_chart.panels(found)
    assert [panel.scene for panel in panels] == ["restitution, sphere", "restitution, capsule"]
    assert panels[0].conclusion.startswith("Largest difference: avatarsim/default") and "lost bodies" in panels[1].conclusion
    (tmp_path / law_map.ROWS).write_text(MAP.replace("0.50000001", "0.6").replace("0.49999999", "0.4"))
    spoilt = law_map.load(tmp_path)
    assert spoilt is not None
    assert law_map.conclusion(spoilt).startswith("Ours misses what is asked by more than 1e-06 in restitution 0.5 of sphere")


def test_shades_grow_with_the_error() -> None:
    cells = [law_map.Cell("l", "s", "r", 60, 0.5, 0.5, 0.5, 0.5 + off, "") for off in (0.0, 0.005, 0.02, 0.05, 0.2, math.nan)]
    shades = [law_map_chart.shade(cell) for cell in cells]
    assert shades[0] == 0.0 and shades == sorted(shades) and shades[-1] == shades[-2]
    assert law_map_chart.cell_text(cells[1]) == "0.5000 (0.500 to 0.505)" and law_map_chart.cell_text(cells[0]) == "0.5000"


def test_the_page_has_the_sections_only_when_their_files_are_there(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    write_report(folder)
    bare = (folder / "index.html").read_text(encoding="utf-8")
    assert 'id="sweep"' not in bare and 'id="law-map"' not in bare
    (folder / sweep.ROWS).write_text(HEAD + WON + SHORT)
    (folder / convergence.ROWS).write_text(CONVERGENCE)
    (folder / law_map.ROWS).write_text(MAP)
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    tree = Tree()
    tree.feed(page)
    for name in ("sweep", "convergence", "law-map"):
        assert f'id="{name}"' in page
    assert 'href="#sweep"' in page and "takes ×5.00, not ×10" in page
    assert 'id="cheapest"' in page and "Performance profile" in page and "at most 1 mm" in page
    assert "none of 1 setting measured here" in page and "ours is kinematic" in page


def test_a_factor_that_is_none_has_a_reason_and_errors_have_words(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    (folder / sweep.ROWS).write_text(
        HEAD.replace("note\n", "note,rests,p95,sleeps\n")
        + "stack,avatarsim,default,residual_overlap_max,m,0,0.4,,measured,all,1e-06,,0.8,1500,1\n"
        + "stack,mujoco,tuned,residual_overlap_max,m,0,400,,measured,own,1e-06,,0.8,700,0\n"
    )
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "×nan" not in page and "mujoco/tuned: no factor, since what rests sleeps in the median frame" in page
    assert ">residual_overlap_max<" not in page and "stack. deepest overlap shown against frame time (the 95th" in page


def test_picture_list_and_front_have_the_time_that_is_compared(tmp_path: Path) -> None:
    more = "rests,moving,at_rest,sleeps,slowest\n"
    (tmp_path / sweep.ROWS).write_text(
        HEAD.replace("note\n", f"note,{more}")
        + "stack,avatarsim,default,residual_overlap_max,m,0,0.401,,measured,all,1e-06,,0.99,,,1,3974\n"
        + "stack,mujoco,tuned,residual_overlap_max,m,0,288,,measured,own,1e-06,,0.98,,,0,563\n"
        + "drop,avatarsim,default,residual_overlap_max,m,0,0.401,,measured,all,1e-06,,0.7,2.28,0.4,1,54\n"
        + "drop,mujoco,tuned,residual_overlap_max,m,0,143,,measured,own,1e-06,,0.7,61.2,143,0,148\n"
    )
    found = sweep.load(tmp_path)
    assert found is not None
    assert {p.run: p.front for p in found.points if p.scenario == "stack"} == {"avatarsim/default": "own", "mujoco/tuned": "all"}
    by_scene = {panel.scenario: panel for panel in sweep_chart.panels(found)[0]}
    stack, drop = by_scene["stack"], by_scene["drop"]
    assert stack.points == (("mujoco/tuned", "0", "563 µs"), ("avatarsim/default", "0", "3.97 ms"))
    assert drop.points == (("avatarsim/default", "0", "2.28 µs"), ("mujoco/tuned", "0", "61.2 µs"))
    assert stack.conclusion.startswith("Deepest overlap") and "time, as drawn: the slowest frame" in stack.conclusion
    assert "time, as drawn: the median of frames in motion" in drop.conclusion and "against frame time (the slowest" in stack.svg
    assert "avatarsim/default: 0, 3.97 ms (the slowest frame), 401 ns per frame (median)" in stack.svg
    left = sweep_chart.is_beaten
    ours, theirs = (p for p in found.points if p.scenario == "stack")
    assert not left(ours, (ours, replace(theirs, engine="avatarsim"))) and left(
        ours, (ours, replace(theirs, engine="avatarsim")), Basis.SLOWEST)


def test_half_of_a_surrogate_pair_in_a_file_costs_a_sign_and_not_the_page(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    (folder / sweep.ROWS).write_text(HEAD + WON)
    (folder / "sweep.json").write_text('{"form": "short", "seconds": "\\ud800", "scenes": ["wall"]}')
    write_report(folder)
    assert "short sweep of ? s" in (folder / "index.html").read_text(encoding="utf-8")


def test_few_frames_have_a_slowest_and_no_percentile_and_one_repeat_has_no_tail(tmp_path: Path) -> None:
    (point, *_) = loaded(tmp_path, WON).points
    few = replace(point, p95=30.0, slowest=50.0, repeats=3, frames=60)
    assert (few.tail, few.tail_said, few.has_tail) == (50.0, "slowest of 60 frames", True)
    many = replace(few, frames=200)
    assert (many.tail, many.tail_said) == (30.0, "95th percentile") and not replace(many, repeats=1).has_tail
    assert replace(few, slowest=math.nan).tail_said == "95th percentile of 60 frames"


def test_a_gap_is_said_beside_the_error_that_does_not_count_it(tmp_path: Path) -> None:
    (point, *_) = loaded(tmp_path, WON).points
    assert replace(point, gap=4e-3).hovers == "hovers 4.00 mm" and point.hovers == replace(point, gap=5e-7).hovers == ""
    assert "hovers 4.00 mm" in sweep_chart.tooltip(replace(point, gap=4e-3))


def test_the_model_of_a_setting_is_its_own_or_one_that_it_can_be_set_in(tmp_path: Path) -> None:
    turned = replace(loaded(tmp_path, WON).points[0], scenario="wall", engine="mujoco", setting="tuned iterations=9",
                     base="tuned", settable="opt.iterations = 9")
    (tmp_path / "native").mkdir()
    assert sweep.load(tmp_path) is not None and sweep.Sweep((turned,)).model(turned) == ("", "")
    names = ("tuned.0.xml.gz", "tuned.0.steps.npz", "tuned.dt=1_60.x.0.xml.gz", "mine.0.xml.gz")
    for name in (*(f"wall.mujoco.{name}" for name in names), "wall_b.mujoco.tuned.0.xml.gz"):
        (tmp_path / "native" / name).write_bytes(b"")
    found = sweep.load(tmp_path)
    assert found is not None
    tuned = "native/wall.mujoco.tuned.0.xml.gz"
    assert found.model(turned) == (tuned, "model as compiled of tuned, to set that in")
    assert found.model(replace(turned, setting="tuned", settable="")) == (tuned, "model as compiled")
    assert found.model(replace(turned, setting="tuned dt=1/60", settable="")) == ("", "")
    assert found.model(replace(turned, setting="mine", settable="")) == ("native/wall.mujoco.mine.0.xml.gz", "model as compiled")
    assert found.model(replace(turned, base="default", setting="default", settable="")) == ("", "")


def test_what_changes_the_step_is_run_with_its_row(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    row = '"mujoco.x = {preset = ""tuned"", dt = 0.1}"'
    (folder / sweep.ROWS).write_text(
        HEAD.replace("note\n", "note,base,options,native\n")
        + "wall,avatarsim,default,residual_overlap_max,m,0,10,,measured,all,1e-06,,default,--engine avatarsim,\n"
        + f"wall,mujoco,tuned dt=1/60,residual_overlap_max,m,0,8,,measured,all,1e-06,,tuned,{row},opt.timestep = 0.1\n"
    )
    (folder / "native").mkdir(exist_ok=True)
    (folder / "native" / "wall.mujoco.tuned.0.xml.gz").write_bytes(b"")
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "contact parameters follow the step: run it with this row" in page and "opt.timestep" not in page
    assert "to set that in" not in page and "wall.mujoco.tuned.0.xml.gz" not in page
    (point,) = (p for p in loaded(folder, WON).points if p.setting == "tuned dt=1/60")
    other = replace(point, options="pybullet.x = {preset = 1, dt = 0.1}", engine="pybullet", base="tuned")
    assert other.by_row.endswith("what an avatar is told in them, follow the step: run it with this row")
    margin = replace(other, options="pybullet.x = {preset = 1, margin = 0.1}")
    assert margin.by_row == "more follows from it than one line says: run it with this row"
    assert not replace(margin, settable="x").by_row and not replace(margin, setting="tuned").by_row


def test_a_preset_of_the_run_that_the_sweep_has_not_is_named_beside_the_cells(run_dir: Write, results: Json) -> None:
    rows = [row("wall", run, metric, value, unit) for run, time in (("mujoco/tuned", 35.0), ("mujoco/sleeping", 20.0))
            for metric, value, unit in (("frame_time_p50", time, "us"), ("residual_overlap_max", 1e-5, "m"))]
    rows += [row("wall", run, "frame_time_p50", 1.0, "us") for run in ("tracker/default", "mujoco/default")]
    folder = run_dir(results | {"rows": rows})
    (folder / sweep.ROWS).write_text(HEAD + WON + line("wall", "mujoco/default", 1e-3, 40))
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert ("Presets that are no settings of this sweep, and so in no cell; medians of all frames by the run's own timing pass: "
            "mujoco/sleeping 20.0 µs, leaves 10.0 µm.") in page.replace("&#39;", "'")
    bare = loaded(folder, WON + line("wall", "mujoco/sleeping", 1e-5, 20))
    block = sweep_chart.table(bare).blocks[0]
    assert "sleeping" not in elsewhere(load(folder), bare, block) and elsewhere(None, bare, block) == ""


def test_what_hovers_less_is_not_drawn_as_beaten_by_what_stays_off(tmp_path: Path) -> None:
    text = line("wall", "m/a", 2e-4, 10) + line("wall", "m/b", 1e-4, 9) + line("wall", "m/c", 3e-4, 11)
    near, far, slow = loaded(tmp_path, text).points
    near, far, slow = replace(near, gap=2e-5), replace(far, gap=1e-3), replace(slow, gap=1e-3)
    assert not sweep_chart.is_beaten(near, (near, far, slow)) and sweep_chart.is_beaten(slow, (near, far, slow))
    assert sweep_chart.is_beaten(replace(near, gap=math.nan), (replace(far, gap=math.nan),)), "without an avatar there is no gap"


def test_a_preset_that_errs_more_at_another_frame_rate_says_so_beside_its_cell(run_dir: Write, results: Json) -> None:
    rows = [row(scene, "mujoco/tuned", "residual_overlap_max", value, "m")
            for scene, value in (("table", 1e-5), ("table_90hz", 1.47e-3))]
    scenes = {"table": {"title": "", "family": "table"}, "table_90hz": {"title": "", "family": "table"}}
    found = load(run_dir(results | {"rows": rows, "scenes": scenes}))
    (preset, turned) = (replace(point, scenario="table") for point in loaded(
        run_dir(results), line("table", "mujoco/tuned", 1e-5, 9) + line("table", "mujoco/tuned margin=0", 1e-5, 9)).points)
    of = sweep_chart.at_other_rates
    assert of(found, preset, ("residual_overlap_max",)) == "1.47 mm in table_90hz"
    assert of(found, replace(turned, base="tuned"), ("residual_overlap_max",)) == "tuned: 1.47 mm in table_90hz"
    ours = replace(preset, engine="avatarsim", setting="default", base="default")
    told = load(run_dir(results | {"scenes": scenes, "rows": [
        row("table", "avatarsim/default", "residual_overlap_max", 0.0, "m"),
        row("table_90hz", "avatarsim/default", "residual_overlap_max", 2e-3, "m"),
        row("table_90hz", "avatarsim/paper", "residual_overlap_max", 9e-3, "m")]}))
    assert of(told, ours, ("residual_overlap_max",)) == "2.00 mm in table_90hz", "ours is warned of by the same rule"
    assert of(None, preset, ("residual_overlap_max",)) == of(found, preset, ("drift_max",)) == ""


def test_another_preset_of_ours_is_a_curve_and_on_no_front(tmp_path: Path) -> None:
    found = loaded(tmp_path, WON + line("wall", "avatarsim/paper", 0, 7, front="all")
                   + line("wall", "avatarsim/default steps=1", 0, 9))
    fronts = {point.run: point.front for point in found.points}
    assert fronts["avatarsim/paper"] == "" and fronts["avatarsim/default steps=1"] == "all"
    assert fronts["avatarsim/default"] == "" and fronts["mujoco/tuned dt=1/60"] == "all"
    assert "avatarsim/paper" in sweep_chart.inks(found)
    (panel,), _ = sweep_chart.panels(found)
    assert ("avatarsim/paper", "0", "7.00 µs") in panel.points and "paper 0 in" not in panel.svg
    assert {p.run for p in found.rivalries[0].front} == {"avatarsim/default steps=1", "mujoco/tuned dt=1/60"}
