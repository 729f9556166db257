"""Effects in words: every row of the table, every scene's own, and what an author gave up."""

from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.scene.effects import CALLS
from scenarios import catalog
from scenarios.run.effects_said import LISTED, effects_of, lapse_said, lines_of, parts_named, table_of_calls
from scenarios.scenario import Scenario
from tests.scenarios.command_line import called, latest


def narrowed(*effects: str) -> Scenario:
    """A ball that is dropped, with effects left out by the scene's author."""
    scenario = catalog.get("ball_drop")
    scene = replace(scenario.build(), narrow=effects)
    return replace(scenario, name="narrowed", build=lambda: scene)


@pytest.fixture
def hurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """A catalogue of one scene without continuous detection."""
    found = {"narrowed": narrowed("continuous")}
    monkeypatch.setattr(catalog, "scenarios", lambda: found)
    monkeypatch.setattr(catalog, "get", found.__getitem__)


def test_the_table_says_of_every_effect_who_calls_and_what_lapses() -> None:
    said = " ".join(table_of_calls().split())
    for call in CALLS:
        assert f"{call.effect} {call.part}: {call.why}" in said
    assert said.count("lapses") == len(CALLS) - 1 and "kinematics" in said and "Cannot be left out" in said


def test_a_scene_says_which_part_calls() -> None:
    scene = catalog.get("ball_drop").build()
    assert any(line.split()[0] == "restitution" and "metal" in line or "wood" in line for line in lines_of(scene))
    assert effects_of(scene)["lapsed"] == {}
    gone = narrowed("friction").build()
    assert lines_of(gone)[-1] == "friction         left out by its author: promise 3 (bounces as stated) lapses"
    assert effects_of(gone)["switched_off"] == ["friction"] and "friction" not in effects_of(gone)["effects"]


def test_many_parts_are_counted() -> None:
    assert parts_named(("a", "b")) == "a, b"
    assert parts_named(tuple("abcde")) == "a, b, c and 2 more" and LISTED == 3
    assert "forced" in parts_named(())


def test_nothing_lapses_where_nothing_was_left_out() -> None:
    assert lapse_said("s", {}) == ""
    assert "promise 3" in lapse_said("s", {"friction": "3 (bounces as stated)"})


@pytest.mark.usefixtures("hurried")
def test_a_narrowed_scene_stands_outside_the_gate_and_the_judge_shows_what_it_costs(
    site: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(tmp_path, "check", frames=60) == 0
    said = capsys.readouterr()
    assert "narrowed stands outside the gate" in said.err and "continuous: promise 1 (no overlap) lapses" in said.err
    found = latest(tmp_path)
    (row,) = [row for row in found["rows"] if row["metric"] == "residual_overlap_max"]
    assert row["status"] == "info" and row["value"] > 1e-3 and "outside the gate" in row["note"]
    assert any("outside the gate" in note for note in found["notes"])
    assert {row["status"] for row in found["rows"]} == {"info"}
