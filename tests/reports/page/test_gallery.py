"""A card for every scene, with what the gate says, the worst figures, and whether another engine is better."""

from collections.abc import Callable
from pathlib import Path

from reports import write_report
from reports.deciding.tables import blocks
from reports.deciding.verdict import verdict
from reports.page.gallery import Picture, cards, families, sentence
from reports.reading.load import load
from tests.reports.conftest import row
from tests.reports.recorded import recording, scene

Json = dict[str, object]
Write = Callable[[object], Path]


def made(folder: Path) -> dict[str, object]:
    results = load(folder)
    found = cards(results, blocks(results), verdict(results), {"arm_wall": Picture("<svg/>", 1.5)})
    return {"cards": {card.scene: card for card in found}, "families": families(found), "sentence": sentence(found)}


def test_cards_say_what_the_gate_says(run_dir: Write, results: Json) -> None:
    found = made(run_dir(results))["cards"]
    assert isinstance(found, dict) and list(found) == ["arm_wall", "hand_over_table", "ball_drop"]
    assert found["arm_wall"].status == "passed"
    young = found["hand_over_table"]
    assert young.status == "waived" and "1 of 1" in young.said
    assert found["ball_drop"].status == "failed" and "1 of 1" in found["ball_drop"].said
    assert found["arm_wall"].picture.svg == "<svg/>" and found["ball_drop"].picture.svg == ""
    assert found["arm_wall"].figures == (("overlap", "300 nm (avatarsim)"), ("others up to", "4.00 mm (mujoco/default)"))
    assert found["ball_drop"].behind == ("error of restitution 0.3, best other 0.02 (pybullet/default)",)


def test_of_a_scene_that_ours_refuses_no_depth_of_others_is_told(run_dir: Write, results: Json) -> None:
    """The scene prescribes a first pose that overlaps: an engine that takes it shows it."""
    rows = [row("deep", "avatarsim/default", "run", None, status="refused", note="overlap at the start"),
            row("deep", "mujoco/default", "residual_overlap_max", 0.2, "m")]
    found = made(run_dir(results | {"rows": rows, "series": {}}))["cards"]
    assert isinstance(found, dict) and found["deep"].figures == () and found["deep"].said == "refused, as it should be"


def test_what_is_no_number_is_the_worst_of_the_others(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    changed = [row | {"value": "NaN"} if (row["scenario"], row["engine"], row["metric"]) ==
               ("arm_wall", "pybullet", "residual_overlap_max") else row for row in rows]
    found = made(run_dir(results | {"rows": changed}))["cards"]
    assert isinstance(found, dict) and found["arm_wall"].figures[1] == ("others up to", "NaN (pybullet/default)")


def test_families_are_those_of_the_file_or_the_scene_itself(run_dir: Write, results: Json) -> None:
    assert dict(made(run_dir(results))["families"]) == {"arm_wall": 1, "ball_drop": 1, "hand_over_table": 1}  # type: ignore[call-overload]
    named = results | {"scenes": {"arm_wall": {"title": "An arm.", "family": "hand_over_table"}}}
    found = made(run_dir(named))
    assert found["families"] == (("hand_over_table", 2), ("ball_drop", 1))
    assert found["sentence"] == "3 scenes in 2 families; in 1 of them another engine is better in at least one measure."


def test_every_scene_of_a_family_says_its_own_losses_what_is_seen_first(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    for name, jump in (("arm_wall", 0.174), ("hand_over_table", 0.473)):
        rows += [row(name, "avatarsim/default", "jerk_ratio", 4.0), row(name, "mujoco/tuned", "jerk_ratio", 1.0)]
        rows.append(row(name, "avatarsim/default", "link_jump_max", jump, "m"))
        rows.append(row(name, "mujoco/tuned", "link_jump_max", 0.05, "m"))
    scenes = {"arm_wall": {"family": "walls"}, "hand_over_table": {"family": "walls", "scale": 1.0}}
    found = made(run_dir(results | {"scenes": scenes}))
    told = found["cards"]
    assert isinstance(told, dict)
    assert [told[name].behind[0] for name in ("arm_wall", "hand_over_table")] == [
        "jump of a link in a frame beyond its target's 174 mm, best other 50.0 mm (mujoco/tuned)",
        "jump of a link in a frame beyond its target's 473 mm, best other 50.0 mm (mujoco/tuned)",
    ]
    assert all(told[name].behind[-1].startswith("roughness of motion") for name in ("arm_wall", "hand_over_table"))
    assert "in 3 of them another engine is better" in str(found["sentence"])


def test_the_index_shows_the_pictures_and_leads_to_the_moment(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    scene(folder, "arm_wall")
    recording(folder, "arm_wall", "avatarsim/default")
    write_report(folder)
    text = (folder / "index.html").read_text(encoding="utf-8")
    part = text.split('id="scenes"')[1].split("</section>")[0]
    assert part.count("<li id=") == 3 and part.count('<svg class="thumb"') == 1 and part.count("not recorded") == 2
    # most contacts at the last of twenty states; without a script all cards are there, and no filter
    assert 'href="scenes/arm_wall.html#t=0.316667"' in part and "hidden>" in part.split("<ul>")[0]
    assert "The scene arm_wall at 0.317 s, as avatarsim/default shows it." in part
