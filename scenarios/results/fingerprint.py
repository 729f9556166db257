"""Content hash of what a result depends on: scene and motion, sources and version of engine and measures, settings, seed.

An edit of one engine's adapter, of one scene or of one preset changes the keys of what it can change, and no others.
"""

import hashlib
import re
from collections.abc import Iterable, Iterator
from contextlib import closing
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from pkgutil import walk_packages

from avatarsim.errors import MissingPackage
from avatarsim.running.sources import version
from runfiles.engines import about
from scenarios import catalog
from scenarios.engines import BUILT_IN, EXTRA, known, opened
from scenarios.job import Job
from scenarios.results.provenance import CODE, ROOT, scene_hash

JUDGES = ("numpy", "scipy", "coal")
"""Distributions that decide what is measured."""
MEASURES = ("scenarios/running/run.py", "scenarios/studies/sweep/measure.py")
"""Where the measuring begins; what these import is part of it."""
SCHEMA = "1"
"""Raise it when an entry of the store means something else than before."""

_IMPORT = re.compile(rf"^\s*(?:from|import)\s+((?:{'|'.join(CODE)})[\w.]*)(?:\s+import\s+(\([^)]*\)|[^\n]*))?", re.MULTILINE)


def key_of(job: Job) -> str:
    """Twenty-four hexadecimal digits of all that decides what `job` shows and what is measured of it."""
    asked = (
        job.scenario, job.engine, job.base or job.preset, sorted(job.options.items()), job.seed, job.full, job.frames,
        job.catalogue, job.narrow, job.force,
    )
    return _digest((SCHEMA, repr(asked), scene_part(job), engine_part(job.engine), measure_part()))[:24]


def scene_part(job: Job) -> str:
    """The scene, the motion at the length that is run, and the sources of what is expected of it."""
    return _scene_part(job.scenario, job.seed, job.full, job.frames, job.catalogue, job.narrow, job.force)


@cache
def _scene_part(name: str, seed: int, full: bool, frames: int | None, catalogue: str, *effects: tuple[str, ...]) -> str:
    job = Job(name, "", "", seed, full, frames, catalogue=catalogue, narrow=effects[0], force=effects[1])
    scenario, scene, motion = job.asked()
    digest = hashlib.blake2b(digest_size=12)
    digest.update(f"{scene_hash(scene)} {scenario.frames} {scenario.dt!r}".encode())
    for k in range(scenario.frames):
        sample = motion(k)
        for array in (sample.positions, sample.rotations, sample.angles):
            digest.update(array.tobytes())
    return digest.hexdigest() + sources([*_exporting(name), find(catalogue)])


@cache
def engine_part(name: str) -> str:
    """The version of an engine and the sources that it is made of; for unknown names and modules, a text that says so."""
    paths = known()
    module = paths.get(name, "").partition(":")[0]
    if not module:
        return name
    if name not in BUILT_IN:
        return joined_part(name, module)
    versions = ",".join(f"{package} {version(package)}" for package in about(name).packages)
    try:
        return f"{name} {versions} {sources([find(module)])}"
    except MissingPackage:
        # the row will say what is missing; its key must exist all the same
        return f"{name} {versions} absent"


def joined_part(name: str, module: str) -> str:
    """The same of an engine that joined by an entry point: the version it says, every source file of the package that its module
    is in, and the files of this project that these import. Compiled parts and a simulator beneath count only by that version."""
    try:
        files = _package(module)
        with closing(opened(name)) as engine:
            said = engine.version
    except Exception as error:
        # the code of others: what it raises, the row will say; its key must exist all the same
        return f"{name} absent: {type(error).__name__}"
    return f"{name} {said} {sources(files)}"


def _package(module: str) -> list[Path]:
    """Every source file of the package that a module is in; the module's alone where it is in none, or in a namespace."""
    top = find_spec(module.partition(".")[0])
    if top is None or top.origin is None or not top.submodule_search_locations:
        return [find(module)]
    return sorted(Path(top.origin).parent.rglob("*.py"))


@cache
def measure_part() -> str:
    """The sources and versions of everything that measures."""
    versions = ",".join(f"{package} {version(package)}" for package in JUDGES)
    return f"{versions} {sources([ROOT / path for path in MEASURES])}"


def find(module: str) -> Path:
    """The file of a module, without importing it (its parents are)."""
    try:
        spec = find_spec(module)
    except ImportError as error:
        raise MissingPackage(error.name or module, EXTRA, f"module {module}") from error
    if spec is None or spec.origin is None:
        raise MissingPackage(module, EXTRA, f"module {module}")
    return Path(spec.origin)


def _exporting(name: str) -> Iterator[Path]:
    """The file of the catalogue that exports a scenario; none for scenarios that are made elsewhere."""
    plain = name.partition("~")[0]
    for info in walk_packages(catalog.__path__, f"{catalog.__name__}."):
        if not info.ispkg:
            exports = import_module(info.name)
            family = getattr(exports, "SCENARIOS", None) or (exports.SCENARIO,)
            if any(scenario.name == plain for scenario in family):
                yield find(info.name)


def sources(beginning: Iterable[Path]) -> str:
    """Hash of these files and of every file of the project that they import, directly or not; where they lie counts only below
    the project's root."""
    found: set[Path] = set()
    waiting = list(beginning)
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting += imported(path)
    parts = [f"{path.relative_to(ROOT) if path.is_relative_to(ROOT) else path.name} {_content(path)}" for path in found]
    return _digest(sorted(parts))


@cache
def imported(source: Path) -> tuple[Path, ...]:
    """Files of the project named in the import lines of `source`, those within functions too."""
    found = []
    for match in _IMPORT.finditer(source.read_text(encoding="utf-8", errors="replace")):
        names = re.findall(r"\w+", re.sub(r"\bas\s+\w+", "", match.group(2) or ""))
        stem = ROOT.joinpath(*match.group(1).split("."))
        for path in (stem, *(stem / name for name in names)):
            found += [file for file in (path.with_suffix(".py"), path / "__init__.py") if file.is_file()]
    return tuple(found)


@cache
def _content(source: Path) -> str:
    return hashlib.blake2b(source.read_bytes(), digest_size=12).hexdigest()


def _digest(parts: Iterable[str]) -> str:
    digest = hashlib.blake2b(digest_size=16)
    for part in parts:
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()
