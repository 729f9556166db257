"""The lock: every pin has a hash, none is missing, no address of a user is in it, and it agrees with pyproject.toml."""

import re
import runpy
import tomllib
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from setuptools import find_packages

from avatarsim.version import VERSION

ROOT = Path(__file__).resolve().parents[2]
LOCK = (ROOT / "requirements.lock").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def _pins() -> dict[str, str]:
    """Return the pinned versions by canonical name."""
    found = re.findall(r"(?m)^([\w.-]+)==([^\s;]+)", LOCK)
    return {canonicalize_name(name): version for name, version in found}


def _asked() -> list[Requirement]:
    """Return the requirements of pyproject.toml, of the core and of every extra that is locked."""
    extras = PROJECT["project"]["optional-dependencies"]
    lines = PROJECT["project"]["dependencies"] + PROJECT["build-system"]["requires"]
    lines += [line for extra in runpy.run_path(str(ROOT / ".setup" / "lock.py"))["EXTRAS"] for line in extras[extra]]
    return [Requirement(line) for line in lines]


def test_lock_holds_pins_and_hashes_and_nothing_else() -> None:
    allowed = re.compile(r"#.*|[\w.-]+==[\w.]+( ; [^\\]+)? \\|    --hash=sha256:[0-9a-f]{64}( \\)?")
    assert [line for line in LOCK.splitlines() if not allowed.fullmatch(line)] == []
    assert "://" not in LOCK


def test_every_pin_has_a_hash_and_one_version() -> None:
    blocks = re.split(r"(?m)^(?=\w)", LOCK)[1:]
    assert len(blocks) == len(_pins()) > 50
    assert [block.splitlines()[0] for block in blocks if "--hash=sha256:" not in block] == []


def test_pins_satisfy_pyproject() -> None:
    pins = _pins()
    for asked in _asked():
        pin = pins.get(canonicalize_name(asked.name), "none")
        assert pin != "none" and asked.specifier.contains(pin), f"asked {asked}, locked {pin}"


def test_lock_is_closed_under_requirements() -> None:
    pins = _pins()
    missing = set()
    for name in pins:
        try:
            required = metadata.requires(name) or []
        except metadata.PackageNotFoundError:
            continue  # pinned for another platform or Python
        for line in map(Requirement, required):
            if line.marker is None or line.marker.evaluate({"extra": ""}):
                pin = pins.get(canonicalize_name(line.name))
                if pin is None or not line.specifier.contains(pin):
                    missing.add(f"{name} needs {line}, the lock has {pin}")
    assert sorted(missing) == []


def test_exactly_one_distribution_brings_mujoco() -> None:
    assert [name for name in _pins() if name.startswith("mujoco")] == ["mujoco"]


def test_the_newest_release_is_the_version_of_the_package() -> None:
    released = re.findall(r"(?m)^## \[([\d.]+)\]", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    assert released[0] == VERSION


def test_only_avatarsim_ships() -> None:
    include = PROJECT["tool"]["setuptools"]["packages"]["find"]["include"]
    shipped = set(find_packages(str(ROOT), include=include))
    folders = {path.parent for path in (ROOT / "avatarsim").rglob("*.py")}
    assert shipped == {".".join(folder.relative_to(ROOT).parts) for folder in folders}


def test_registered_engines_ship() -> None:
    for name, place in PROJECT["project"]["entry-points"]["avatarsim.engines"].items():
        module = place.partition(":")[0]
        assert (ROOT / (module.replace(".", "/") + ".py")).exists(), f"{name} = {place}"
        assert module.startswith("avatarsim."), "only avatarsim is in the wheel"
