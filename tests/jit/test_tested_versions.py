"""An untested numba or llvmlite causes a warning, and a part that it lacks becomes a sentence."""

import ast
import tomllib
from pathlib import Path

import llvmlite
import numba
import pytest
from packaging.requirements import Requirement

from avatarsim.errors import AvatarsimError, UnsupportedVersion
from avatarsim.jit import tested_versions
from avatarsim.jit.packages import TESTED
from avatarsim.jit.source_hash import ROOT
from avatarsim.jit.tested_versions import PRIVATE, guarded, missing, untested


def test_what_is_installed_is_tested_and_errors_pass() -> None:
    assert untested() == [] == missing()
    with guarded():
        pass
    with pytest.raises(ImportError, match="^no such part$"), guarded():
        raise ImportError("no such part")


@pytest.mark.parametrize(("package", "version"), [("numba", "0.69.0"), ("numba", "1.68.0"), ("llvmlite", "0.51.0rc1")])
def test_warns_of_another_minor_version_not_of_a_patch(
    package: str, version: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = {"numba": numba, "llvmlite": llvmlite}[package]
    monkeypatch.setattr(module, "__version__", "{}.{}.99".format(*TESTED[package]))
    with guarded():
        pass
    monkeypatch.setattr(module, "__version__", version)
    with pytest.warns(RuntimeWarning, match=f"{package} {version}"), guarded():
        pass


@pytest.mark.parametrize("part", ["numba.core.registry.CPUDispatcher", "numba.core.typing.templates.AttributeTemplate"])
def test_a_private_part_that_is_gone_is_named(part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba, "__version__", "0.99.0")
    monkeypatch.delattr(part)
    with pytest.raises(UnsupportedVersion, match=part) as caught, guarded():
        pytest.fail("went on")
    assert isinstance(caught.value, AvatarsimError) and isinstance(caught.value, ImportError)


@pytest.mark.parametrize("changed", [ImportError("cannot import name 'X'"), AttributeError("no attribute 'X'")])
def test_a_private_part_that_changed_is_named(changed: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba, "__version__", "0.99.0")
    with pytest.warns(RuntimeWarning), pytest.raises(UnsupportedVersion, match="'X'"), guarded():
        raise changed


def test_the_list_of_private_parts_is_what_the_engine_imports() -> None:
    found: dict[str, set[str]] = {}
    for file in ROOT.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("numba.") and node.module != "numba.extending":
                found.setdefault(str(node.module), set()).update(alias.name for alias in node.names)
    assert {module: set(names) for module, names in PRIVATE.items()} == found


def test_pyproject_lets_no_later_minor_version_be_installed() -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    asked = {one.name: one.specifier for one in map(Requirement, project["project"]["dependencies"])}
    assert tested_versions.installed().keys() == TESTED.keys()
    for package, (major, minor) in TESTED.items():
        assert asked[package].contains(f"{major}.{minor}.7")
        assert not asked[package].contains(f"{major}.{minor + 1}.0") and not asked[package].contains(f"{major + 1}.0")
