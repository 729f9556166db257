"""Effects of scenes, as used by `list` and the gate."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from scenarios import catalog
from scenarios.cli.listing import effects_of
from tests.scenarios.command_line import called, latest


def test_narrowed_effect_is_switched_off_and_lapses() -> None:
    scene = catalog.get("ball_drop").build()
    found, less = (dict[str, Any](effects_of(one)) for one in (scene, replace(scene, narrow=("friction",))))
    assert {"restitution", "friction"} <= set(found["effects"]) and found["called_by"]["restitution"] and not found["lapsed"]
    assert less["switched_off"] == ["friction"] == list(less["lapsed"]) and "friction" not in less["effects"]


def test_a_narrowed_scene_is_measured_and_not_gated(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = catalog.get("ball_drop")
    scene = replace(scenario.build(), narrow=("continuous",))
    monkeypatch.setattr(catalog, "scenarios", lambda: {"narrowed": replace(scenario, name="narrowed", build=lambda: scene)})
    monkeypatch.setattr(catalog, "get", lambda name: catalog.scenarios()[name])
    assert called(tmp_path, "check", frames=60) == 0
    found = latest(tmp_path)
    (row,) = [row for row in found["rows"] if row["metric"] == "residual_overlap_max"]
    assert row["value"] > 1e-3 and "continuous" in row["note"] and {row["status"] for row in found["rows"]} == {"info"}
    assert any("continuous" in note for note in found["notes"])
