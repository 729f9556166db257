"""A wheel with kernels is for one platform and compiled from its own sources; a plain one has no kernels of earlier builds."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest
import setuptools
from setuptools import Distribution
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.errors import ExecError

ROOT = Path(__file__).parents[2]


@pytest.fixture
def build(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> ModuleType:
    """Return setup.py as a module, in a folder with nothing to build."""
    spec = importlib.util.spec_from_file_location("wheel_build", ROOT / "setup.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with monkeypatch.context() as patch:
        patch.setattr(setuptools, "setup", lambda **_: None)
        spec.loader.exec_module(module)
    monkeypatch.chdir(tmp_path)
    return module


def packed(build: ModuleType, monkeypatch: pytest.MonkeyPatch, with_kernels: bool) -> tuple[bool, list[str]]:
    """Return True if a wheel is for any platform, and the files in it when it is packed after a build that left a kernel."""
    monkeypatch.setattr(build, "add_harness", lambda built: None)
    monkeypatch.setattr(build, "compile_kernels", lambda built: (built / "avatarsim" / "avatarsim-kernels").mkdir(parents=True))
    stale = Path("build/lib/avatarsim/avatarsim-kernels/old")
    stale.mkdir(parents=True)
    held: list[str] = []
    monkeypatch.setattr(bdist_wheel, "run", lambda self: held.extend(str(path) for path in Path("build/lib").rglob("*")))
    command = build.Wheel(Distribution({"name": "x", "version": "1", "py_modules": []}))
    command.initialize_options()
    command.with_kernels = with_kernels
    command.finalize_options()
    command.run()
    return command.root_is_pure, [path for path in held if "kernels" in path]


def test_a_plain_wheel_is_for_any_platform_and_holds_no_kernels(build: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    assert packed(build, monkeypatch, with_kernels=False) == (True, [])


def test_a_wheel_with_kernels_is_for_one_platform(build: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    assert packed(build, monkeypatch, with_kernels=True) == (False, ["build/lib/avatarsim/avatarsim-kernels"])


def test_the_harness_travels_in_a_folder_of_the_package(build: ModuleType, tmp_path: Path) -> None:
    build.add_harness(tmp_path)
    harness = tmp_path / "avatarsim" / "_harness"
    assert {path.name for path in tmp_path.iterdir()} == {"avatarsim"}
    assert {path.name for path in harness.iterdir()} == {"runfiles", "reference", "scenarios", "reports"}
    assert (harness / "scenarios" / "__main__.py").is_file() and (harness / "runfiles" / "metrics.toml").is_file()
    assert not (harness / "reports" / "out").exists() and not list(harness.rglob("*.pyc"))


def test_a_compile_that_fails_stops_the_build(build: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "avatarsim").mkdir()
    (tmp_path / "avatarsim" / "__init__.py").write_text("", encoding="utf-8")  # a package that cannot compile
    with pytest.raises(ExecError, match="--no-build-isolation"):
        build.compile_kernels(tmp_path)
