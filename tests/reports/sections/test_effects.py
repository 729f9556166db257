"""What effects cost, in the report: there when its file is, and its sentences say what the figures say."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports import write_report
from reports.sections.effects import (
    FILE,
    FIRST,
    Ablation,
    absence_sentence,
    answer,
    broken_rows,
    cell,
    consequence,
    cost_sentence,
    forced_cell,
    forced_consequence,
    forced_sentence,
    in_unit,
    load,
    protocol,
    section,
    uncalled,
)
from tests.reports.page.test_page import Tree

Json = dict[str, object]
Write = Callable[[object], Path]


def row(effect: str, share: float | None, broken: list | None = None, moved: float | None = 0.0, scene: str = "drop") -> Json:
    """One line of the file."""
    return {
        "scenario": scene, "effect": effect, "called_by": ["ball"], "with_us": 3.0, "share": share, "moved": moved,
        "without_us": None if share is None else 3.0 * (1.0 - share), "broken": broken or [],
        "note": "" if share is not None else "crashed", "repeats": 3, "frames": 180,
    }


LOST = [["restitution_error_max", 1e-9, 0.3, 1e-6], ["apex_error_max", 0.0, None, 1e-3]]
LINES = [row("restitution", 0.25, LOST), row("sleeping", -1.5), row("friction", 0.01), row("forced", -0.02)]


def fill(folder: Path, lines: list[Json], idle: tuple[str, ...] = (), form: str = "short") -> Ablation:
    told = {"schema_version": 2, "form": form, "idle": {"drop": idle}, "lines": lines}
    (folder / FILE).write_text(json.dumps(told))
    found = load(folder)
    assert found is not None
    return found


def test_nothing_when_it_was_not_asked(tmp_path: Path) -> None:
    assert load(tmp_path) is None


def test_the_dearest_come_first_and_what_saves_time_is_said(tmp_path: Path) -> None:
    said = cost_sentence(fill(tmp_path, LINES))
    assert said == (
        "Of the frame an effect takes, where that is more than noise: restitution 25 % (1 of 1 scene). Paying for themselves, "
        "since a frame takes longer without them: sleeping in drop, 2.5 × as long."
    )
    several = [row("limits", share, scene=f"s{k}") for k, share in enumerate((-0.04, 0.0, 0.62))]
    several += [row("sleeping", share, scene=f"s{k}") for k, share in enumerate((-13.8, -0.18))]
    several += [row("overlap_removal", share, scene=f"s{k}") for k, share in enumerate((0.3, -0.3))]
    assert cost_sentence(fill(tmp_path, several)) == (
        "Of the frame an effect takes, where that is more than noise: limits 62 % (1 of 3 scenes); overlap removal 30 % (1 of 2 "
        "scenes). Paying for themselves, since a frame takes longer without them: sleeping in s0, 14.8 × as long; overlap "
        "removal in s1, 1.3 × as long; sleeping in s1, 1.18 × as long."
    ), "a frame that is 4 % longer without limits says nothing"
    assert cost_sentence(fill(tmp_path, [row("friction", 0.01)])) == "No effect takes a measurable share of the frame."


def test_what_rests_on_an_effect_is_told_from_what_does_not(tmp_path: Path) -> None:
    found = fill(tmp_path, LINES)
    assert absence_sentence(found) == (
        "Bounds rest on restitution in 1 of 1 scene. No bound of these scenes notices the absence of sleeping, friction."
    )
    assert [(effect, lost.metric, lost.without) for effect, _, _, lost in broken_rows(found)] == [
        ("restitution", "restitution_error_max", 0.3), ("restitution", "apex_error_max", None),
    ]


@pytest.mark.parametrize("bad", [row("forced", 0.0, moved=1e-3), row("forced", 0.0, moved=None), row("forced", 0.0, LOST)])
def test_a_forced_effect_that_changes_something_is_named(tmp_path: Path, bad: Json) -> None:
    assert forced_sentence(fill(tmp_path, [bad])) == (
        "Forced on where nothing calls for them, the other effects change the result of drop."
    )


def test_forced_effects_that_change_nothing_are_said_with_their_cost(tmp_path: Path) -> None:
    assert forced_sentence(fill(tmp_path, LINES)) == (
        "Forced on where nothing calls for them, all other effects together move no body at all in 1 scene, and lengthen the "
        "frame by 2 %."
    )
    both = [row("forced", share, scene=f"s{k}") for k, share in enumerate((0.22, -0.06))]
    assert "lengthen the frame by -22 to 6 % (negative: they shorten it)." in forced_sentence(fill(tmp_path, both))


def test_a_cell_is_empty_where_nothing_calls_and_a_dash_where_nothing_was_measured(tmp_path: Path) -> None:
    found = fill(tmp_path, [*LINES, row("coupling", None, scene="other")])
    assert cell(found.at("drop", "coupling")) == "" and cell(found.at("other", "coupling")) == "—"
    assert cell(found.at("drop", "restitution")) == "750 ns" and cell(found.at("drop", "sleeping")) == "-4.50 µs"


def test_the_last_column_has_the_sign_of_its_heading(tmp_path: Path) -> None:
    """Forced on, the others make a frame of 3 us longer by 0.06 us, or shorter by 0.3 us."""
    longer, shorter = (fill(tmp_path, [row("forced", share)]).forced[0] for share in (-0.02, 0.1))
    assert (forced_cell(longer), forced_consequence(longer)) == ("+60.0 ns", "+2 %, none")
    assert (forced_cell(shorter), forced_consequence(shorter)) == ("-300 ns", "-10 %, none")
    assert forced_cell(None) == "—" and forced_consequence(None) == ""


def test_bounds_that_break_have_units() -> None:
    assert in_unit("apex_error_max", 1e-6) == "1.00 µm" and in_unit("apex_error_max", None) == "not measured"
    assert in_unit("restitution_error_max", 0.3) == "0.3"


def test_what_leaving_an_effect_out_changes_is_told(tmp_path: Path) -> None:
    moving = row("coupling", 0.1, moved=0.002)
    found = fill(tmp_path, [*LINES, moving, row("limits", None, moved=None)])
    effects = ("restitution", "coupling", "friction", "limits", "dynamics")
    assert [consequence(found.at("drop", effect)) for effect in effects] == [
        "25 %, breaks 2", "10 %, 2.00 mm", "1 %, none", "not measured", "",
    ]


def test_a_stage_that_ran_though_nothing_calls_for_it_is_named(tmp_path: Path) -> None:
    forced = row("forced", 0.0) | {"called_by": ["overlap_removal", "coupling"]}
    sound = fill(tmp_path, [forced], ("posture", "coupling"))
    assert uncalled(sound) == ()
    assert answer(sound) == "Only what a scene calls for is simulated: zero calls of posture and coupling in drop."
    both = replace(sound, idle={"drop": ("posture", "coupling"), "fall": ("posture", "coupling"), "push": ("coupling",), "x": ()})
    assert answer(both).endswith("zero calls of posture and coupling in drop, fall; coupling in push.")
    wrong = fill(tmp_path, [forced], ("coupling",))
    assert uncalled(wrong) == (("drop", "posture"),)
    assert answer(wrong) == (
        "Not only the effects are simulated that a scene calls for: nothing calls for posture in drop, and it ran."
    )


def test_how_times_were_taken_is_said(tmp_path: Path) -> None:
    assert protocol(fill(tmp_path, LINES)).startswith("Median over 180 frames, each the least of 3 repeats")
    mixed = fill(tmp_path, [*LINES, row("limits", 0.1) | {"frames": 900, "repeats": 2}])
    assert "180 to 900 frames, each the least of 2 repeats" in protocol(mixed)
    assert protocol(fill(tmp_path, [row("limits", None) | {"frames": 0, "repeats": 0}])) == "No times were taken."


@pytest.mark.parametrize("text", [
    "{", '{"schema_version": 2}', '{"schema_version": 2, "form": "short", "idle": {}, "lines": [{}]}',
    '{"schema_version": 2, "form": "short", "idle": 3, "lines": []}', '{"schema_version": 1, "lines": []}',
])
def test_a_file_that_cannot_be_used_is_said_so(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).write_text(text)
    with pytest.raises(InvalidFile, match=FILE):
        load(tmp_path)


def test_the_page_has_the_section_and_stays_whole(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    write_report(folder)
    text = (folder / "index.html").read_text()
    assert "This run has no everyday scene in our engine: <code>make ablate</code>" in text
    fill(folder, [*LINES, row("coupling", None, scene="other")])
    write_report(folder)
    text = (folder / "index.html").read_text()
    tree = Tree()
    tree.feed(text)
    assert tree.open == [] and len(tree.ids) == len(set(tree.ids))
    assert 'id="effects"' in text and "25 %, breaks 2" in text and "not measured" in text
    assert "2.5 × as long without it, none" in text and "-150 %" not in text
    assert "This run has no everyday scene" not in text


def test_many_scenes_are_folded_away(tmp_path: Path) -> None:
    told = section(fill(tmp_path, [row("forced", 0.0, scene=f"scene{k}") for k in range(FIRST + 2)]))
    assert len(told["effects_first"]) == FIRST and told["effects_more"] == (f"scene{FIRST}", f"scene{FIRST + 1}")
