"""Extras: the packages of each, the pins it needs, and the command named when a package is missing."""

import ast
import re
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from avatarsim.assets.models.mujoco_versions import FAULTY
from avatarsim.errors import MissingPackage, bringing

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]


def closure(lines: list[str]) -> set[str]:
    """Return the canonical names of all packages that requirements install, by the metadata of the installed packages."""
    found: set[str] = set()
    open_ = [Requirement(line) for line in lines]
    while open_:
        wanted = open_.pop()
        name = canonicalize_name(wanted.name)
        if name in found:
            continue
        found.add(name)
        try:
            required = metadata.requires(name) or []
        except metadata.PackageNotFoundError:
            continue
        # optional requirements of a package come with the extras that are requested
        for line in map(Requirement, required):
            if line.marker is None or any(line.marker.evaluate({"extra": extra}) for extra in wanted.extras or {""}):
                open_.append(line)
    return found


def named_in_sources() -> list[tuple[str, str, str]]:
    """Return (file, package, extra) of each MissingPackage that is raised with both as literals."""
    found = []
    for path in (*ROOT.glob("avatarsim/**/*.py"), *ROOT.glob("scenarios/**/*.py"), *ROOT.glob("reference/**/*.py")):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "MissingPackage(" in text else ():
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "MissingPackage":
                package, extra = node.args[:2]
                if isinstance(package, ast.Constant) and isinstance(extra, ast.Constant):
                    found.append((path.name, str(package.value), str(extra.value)))
    return found


def test_extras_take_one_range_of_mujoco_and_no_faulty_version() -> None:
    bringing_it = [name for name in EXTRAS if "mujoco" in closure(EXTRAS[name])]
    assert set(bringing_it) == {"assets", "compare", "hand"}
    [taken] = {line for name in bringing_it for line in EXTRAS[name] if Requirement(line).name == "mujoco"}
    assert not any(version in Requirement(taken).specifier for version in FAULTY)
    assert "3.17.0" in Requirement(taken).specifier


def test_each_missing_package_is_in_the_extra_that_is_named() -> None:
    named = named_in_sources()
    assert len(named) >= 4
    for file, package, extra in named:
        listed = {canonicalize_name(Requirement(line).name) for line in EXTRAS[extra]}
        # a package such as pybullet_data belongs to a distribution of another name
        assert canonicalize_name(package) in listed or {
            canonicalize_name(name) for name in metadata.packages_distributions().get(package, ())
        } & listed, f"{file}: {package} is not in {extra}"


def test_an_installed_engine_names_what_its_metadata_lists(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    required = ["numpy>=2.3", 'coacd>=1.0.7; extra == "assets"', 'trimesh>=5.0 ; extra == "assets"', 'viser; extra == "view"']
    monkeypatch.setattr(metadata, "requires", lambda name: required)
    assert bringing("assets", "coacd", tmp_path) == "pip install 'coacd>=1.0.7' 'trimesh>=5.0'"
    assert bringing("nothing", "coacd", tmp_path) == "pip install coacd"


def test_from_a_checkout_the_command_names_its_folder() -> None:
    said = str(MissingPackage("trimesh", "assets", "reading .stl meshes"))
    [(quoted, folder)] = re.findall(r"pip install ('?([^'\[]+)\[assets\]'?), or `make setup`", said)
    assert Path(folder) == ROOT and quoted == f"'{ROOT}[assets]'"
