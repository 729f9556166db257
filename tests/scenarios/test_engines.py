"""Engines by name: built in or by entry points, and classes that are rejected."""

import sys
from pathlib import Path

import pytest

from avatarsim.errors import InvalidInput, MissingPackage, UnknownName
from runfiles.engines import about, engines
from scenarios.engines import absent, engines_to_run, known, opened
from tests.scenarios.bad_engines import NAMES, joined


@pytest.fixture(autouse=True)
def _joined(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    info = tmp_path / "other-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    entries = "mujoco = bad_engines_of_a_stranger:Frozen\nholed = scenarios.no_such_module:Engine\n"
    (info / "entry_points.txt").write_text(f"[avatarsim.engines]\n{entries}")
    monkeypatch.syspath_prepend(joined(tmp_path))


def test_engines_join_through_entry_points_by_new_names() -> None:
    assert list(known())[: len(engines())] == list(engines()) and set(NAMES) < set(known())
    assert opened("frozen").presets == ("default", "other")
    assert known()["mujoco"] == about("mujoco").adapter == engines()["mujoco"].adapter


@pytest.mark.parametrize(("name", "package"), [("mujoco", "mujoco"), ("pybullet", "pybullet"), ("rapier", "rapier3d")])
def test_missing_package_is_named_with_its_extra(name: str, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in [module for module in sys.modules if module.startswith(f"reference.in_{name}")]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MissingPackage, match=rf"{package}.*\[compare\]"):
        opened(name)


def test_absent_engine_is_left_out_unless_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("scenarios.engines.find_spec", lambda package: None if package in ("rapier3d", "sapien") else object())
    assert set(absent()) == {"rapier", "physx"} and "sapien" in absent()["physx"]
    assert {"rapier", "physx"}.isdisjoint(engines_to_run(())) and {"avatarsim", "mujoco", "tracker"} <= set(engines_to_run(()))
    assert "Rapier" in capsys.readouterr().err
    assert engines_to_run(("rapier",)) == ["rapier"]


@pytest.mark.parametrize(("name", "error", "named"), [
    ("mojuco", UnknownName, "'mojuco'.*mujoco"), ("holed", ModuleNotFoundError, "no_such_module"),
    ("no_engine", InvalidInput, r"PurePath.*avatarsim\.engine\.Engine"),
])
def test_a_wrong_engine_is_refused(name: str, error: type[Exception], named: str) -> None:
    with pytest.raises(error, match=named):
        opened(name)
