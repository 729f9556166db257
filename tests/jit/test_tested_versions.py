"""An untested numba or llvmlite is warned of, and what it lacks becomes a sentence."""

import tomllib
from pathlib import Path

import llvmlite
import numba
import pytest
from packaging.requirements import Requirement

from avatarsim.errors import AvatarsimError, UnsupportedVersion
from avatarsim.jit import tested_versions
from avatarsim.jit.tested_versions import TESTED, explained, untested, warn_if_untested


def test_what_is_installed_here_is_tested() -> None:
    assert untested() == []
    warn_if_untested()
    with pytest.raises(ImportError, match="^no such part$"), explained():
        raise ImportError("no such part")


@pytest.mark.parametrize(("package", "version"), [("numba", "0.69.0"), ("numba", "1.68.0"), ("llvmlite", "0.51.0rc1")])
def test_another_minor_version_is_warned_of(package: str, version: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr({"numba": numba, "llvmlite": llvmlite}[package], "__version__", version)
    with pytest.warns(RuntimeWarning, match=rf"not tested with {package} {version} .*pip install 'numba==0"):
        warn_if_untested()


def test_another_patch_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    major, minor = TESTED["numba"]
    monkeypatch.setattr(numba, "__version__", f"{major}.{minor}.99")
    warn_if_untested()


def test_a_private_part_that_is_gone_becomes_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba, "__version__", "0.99.0")
    for gone in (ImportError("cannot import name 'X' from 'numba.core'"), AttributeError("no attribute 'X'")):
        said = r"cannot run with numba 0\.99\.0 .*'X'.*pip install 'numba==0\.68\.\*'"
        with pytest.raises(UnsupportedVersion, match=said) as caught, explained():
            raise gone
        assert isinstance(caught.value, AvatarsimError) and isinstance(caught.value, ImportError)


def test_pyproject_lets_no_later_minor_version_be_installed() -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    asked = {one.name: one.specifier for one in map(Requirement, project["project"]["dependencies"])}
    assert tested_versions.installed().keys() == TESTED.keys()
    for package, (major, minor) in TESTED.items():
        assert asked[package].contains(f"{major}.{minor}.7")
        assert not asked[package].contains(f"{major}.{minor + 1}.0") and not asked[package].contains(f"{major + 1}.0")
