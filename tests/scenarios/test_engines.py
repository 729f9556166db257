"""Engines by name: built in or by entry points, and what is refused."""

import sys
from pathlib import Path

import pytest

from avatarsim.errors import InvalidInput, MissingPackage, UnknownName
from runfiles.engines import about, engines
from scenarios.engines import known, opened
from tests.scenarios.bad_engines import NAMES, joined


@pytest.fixture(autouse=True)
def _strangers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(joined(tmp_path))


def test_engines_join_through_the_entry_points() -> None:
    assert list(known())[:4] == list(engines()) and set(NAMES) < set(known())
    assert opened("frozen").presets == ("default", "other")


def test_an_unknown_engine_lists_those_there_are() -> None:
    with pytest.raises(UnknownName, match="'mojuco'.*mujoco"):
        opened("mojuco")


def test_an_entry_point_cannot_take_a_built_in_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    info = tmp_path / "impostor-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: impostor\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[avatarsim.engines]\nmujoco = bad_engines_of_a_stranger:Frozen\n")
    assert known()["mujoco"] == about("mujoco").adapter


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_a_missing_package_is_named_with_the_extra_that_brings_it(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in [module for module in sys.modules if module.startswith(f"reference.in_{name}")]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(MissingPackage, match=rf"engine {name} needs the package {name}.*pip install .*\[compare\]"):
        opened(name)


def test_a_hole_in_the_engine_itself_is_no_missing_package(tmp_path: Path) -> None:
    info = tmp_path / "holed-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: holed\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[avatarsim.engines]\nholed = scenarios.no_such_module:Engine\n")
    with pytest.raises(ModuleNotFoundError, match="no_such_module"):
        opened("holed")


def test_what_is_no_engine_is_refused() -> None:
    with pytest.raises(InvalidInput, match=r"PurePath.*avatarsim\.engine\.Engine"):
        opened("no_engine")
