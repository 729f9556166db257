"""`avatarsim compare`: verdicts, exit codes, output files, and input that is rejected before anything runs."""

import json
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from avatarsim.drift import read_figures
from avatarsim.errors import InvalidInput, UnknownName
from scenarios.__main__ import main
from scenarios.run.limits import gates_of, limits_of

BOX = """<mujoco><worldbody><geom name="ground" type="plane" size="5 5 .1"/>
<body name="a" pos="0 0 0.3"><freejoint/><geom type="box" size=".1 .1 .1" mass="1"/></body></worldbody></mujoco>"""
LANDS = 40
"""Frames after which the box has landed."""


@pytest.fixture
def box(tmp_path: Path, site: Path) -> str:
    (tmp_path / "box.xml").write_text(BOX)
    return str(tmp_path / "box.xml")


def called(*words: str) -> int:
    return main(["scene", *words, "--jobs", "0", "--frames", str(LANDS)])


def document(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


@pytest.mark.parametrize(("gate", "limit", "code"), [("tunnels/default", "1mm", 1), ("avatarsim", "1um", 0), ("raises", "1m", 3)])
def test_the_exit_code_is_that_of_the_gated_engine(box: str, gate: str, limit: str, code: int) -> None:
    assert called(box, "--engine", "avatarsim", "tunnels", "--gate", gate, "--max-overlap", limit) == code


def test_without_a_limit_the_engine_that_promises_is_gated(box: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert called(box, "--engine", "avatarsim", "tunnels", "--json") == 0
    found = document(capsys)
    assert {f"{row['engine']}/{row['preset']}" for row in found["checks"]} == {"avatarsim/default"}
    assert found["metrics"]["residual_overlap_max"]["unit"] == "m"
    assert {one["run"]: one["state"] for one in found["runs"]}["tunnels/default"] == "measured"


def test_of_several_scenes_each_check_names_its_own(box: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "other.xml").write_text(BOX)
    assert called(box, str(tmp_path / "other.xml"), "--engine", "avatarsim") == 0
    checks = [line for line in capsys.readouterr().out.splitlines() if line.startswith("pass")]
    assert {line.split()[1] for line in checks} == {"own_box", "own_other"}


def test_junit_and_csv_hold_the_checks_and_the_figures(box: str, tmp_path: Path) -> None:
    words = "--engine", "tunnels", "--gate", "tunnels", "raises", "--max-overlap", "1mm", "--max", "status_frames=3"
    assert called(box, *words, "--junit", str(tmp_path / "out.xml"), "--csv", str(tmp_path / "out.csv")) == 1
    cases = list(ElementTree.parse(tmp_path / "out.xml").getroot())
    outcomes = {(case.get("classname"), str(case.get("name")).split()[0]): [part.tag for part in case] for case in cases}
    assert outcomes["own_box.tunnels/default", "residual_overlap_max"] == ["failure"]
    assert outcomes["own_box.tunnels/default", "status_frames"] == []
    assert outcomes["own_box.raises/default", "run"] == ["error"]
    header, *rows = (tmp_path / "out.csv").read_text().splitlines()
    assert header.startswith("scenario,engine,preset") and any(row.startswith("own_box,tunnels,default") for row in rows)


def test_figures_that_were_kept_fail_once_one_has_moved(box: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "box.drift.json"
    words = box, "--engine", "avatarsim", "--drift", str(file)
    assert called(*words) == 2 and not file.exists()
    assert called(*words, "--update-drift") == 0 and called(*words) == 0
    kept = json.loads(file.read_text())
    run = kept["runs"]["own_box avatarsim/default"]
    assert not any(name.startswith("frame_time") for name in run["figures"])
    run["figures"]["residual_overlap_max"], run["version"] = 1.0, "0.0.1"
    file.write_text(json.dumps(kept))
    capsys.readouterr()
    assert called(*words) == 1
    said = capsys.readouterr().out
    assert all(part in said for part in ("residual_overlap_max", "1 m", "0.0.1"))
    file.write_text("{}")
    with pytest.raises(InvalidInput):
        read_figures(file)
    assert called(*words) == 2


def test_missing_engine_fails_only_where_it_is_gated(
    box: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pybullet", None)
    for name in [name for name in sys.modules if name.startswith("reference.in_pybullet")]:
        monkeypatch.delitem(sys.modules, name)
    assert called(box, "--engine", "avatarsim", "pybullet") == 0
    assert "pip install" in capsys.readouterr().out
    assert called(box, "--engine", "avatarsim", "--gate", "pybullet", "--max-overlap", "1m") == 3


@pytest.mark.parametrize(("words", "kind", "named"), [
    (("--engine", "nobody"), "UnknownName", "mujoco"), (("--engine", "tunnels/fast"), "UnknownName", "default"),
    (("--max", "residual_overlap_mux=1"), "UnknownName", "residual_overlap_max"),
    (("--max-overlap", "much"), "InvalidInput", "mm"),
    (("--gate", "tunnels"), "InvalidInput", "--max-overlap"), (("--update-drift",), "InvalidInput", "--drift"),
    (("--motion", "nowhere.csv"), "InvalidFile", "nowhere.csv"), (("--max", "joint_gap_max"), "InvalidInput", "METRIC=VALUE"),
])
def test_2_for_wrong_usage_with_a_typed_error(
    box: str, words: tuple[str, ...], kind: str, named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert called(box, *words) == 2
    said = capsys.readouterr()
    assert kind in said.err and named in said.err
    assert called(box, *words, "--json") == 2
    error = document(capsys)["error"]
    assert error["type"] == kind and error["text"] and error["valid"]


@pytest.mark.parametrize(("text", "value"), [("1mm", 1e-3), ("0.5 cm", 5e-3), ("2e-6m", 2e-6), ("0", 0.0), ("3um", 3e-6)])
def test_a_limit_has_its_unit(text: str, value: float) -> None:
    found = limits_of(text, ["frame_time_p95=2ms", "joint_limit_excess_max=2"])
    assert found == {"residual_overlap_max": pytest.approx(value), "frame_time_p95": 2000.0, "joint_limit_excess_max": 2.0}
    assert limits_of(None, [f"overlap={text}"]) == {"residual_overlap_max": pytest.approx(value)}


@pytest.mark.parametrize(("limit", "error"), [
    ("residual_overlap_max=1", InvalidInput), ("joint_limit_excess_max=1mm", InvalidInput), ("no_such_metric=1", UnknownName),
])
def test_a_limit_without_or_with_a_wrong_unit_is_refused(limit: str, error: type[Exception]) -> None:
    with pytest.raises(error):
        limits_of(None, [limit])


@pytest.mark.parametrize(("gates", "engines", "limited", "found"), [
    (["a/b", "a/b"], ["c"], True, ["a/b"]), ([], ["c", "d/e"], True, ["c", "d/e"]), ([], [], True, ["avatarsim/default"]),
    ([], [], False, ["avatarsim/default"]), ([], ["c"], False, []), ([], ["c", "avatarsim"], False, ["avatarsim/default"]),
])
def test_limits_are_for_gates_then_engines_then_ours(
    gates: list[str], engines: list[str], limited: bool, found: list[str]
) -> None:
    assert gates_of(gates, engines, {"residual_overlap_max": 1e-3} if limited else {}) == found
