"""Facts on engines: one `reference/*/about.toml` each, or one in the package of an engine that joins by an entry point."""

import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from math import isfinite
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Literal

from avatarsim.errors import InvalidFile
from runfiles.metrics import METRICS
from runfiles.naming import GATED
from runfiles.typed_toml import NOT_IN_FILE, read

FOLDER = Path(__file__).parent.parent / "reference"
FILE = "about.toml"
GROUP = "avatarsim.engines"
"""Entry-point group through which other engines join: a class that is constructed without arguments."""
EXTRA = "compare"
"""The extra that brings the packages of an engine whose file names no other."""
Colour = Annotated[str, "#[0-9a-f]{6}"]
Metric = Annotated[str, METRICS]

SPARE = (("#b0498d", "#f08fce"), ("#9a7400", "#e6c04a"), ("#3c8fb3", "#7fd0ef"), ("#7a5cc4", "#b7a0ff"))
"""Colours, light and dark, of engines that no file describes."""


@dataclass(frozen=True)
class Unsupported:
    """A feature that is not set up in an engine.

    metrics  that do not compare the engine in scenes with the feature
    lacks    "engine", the "package" that brings it to Python, or our "adapter"
    presets  that lack it; empty for all
    """

    metrics: tuple[Metric, ...]
    lacks: Literal["engine", "package", "adapter"]
    presets: tuple[str, ...] = ()


@dataclass(frozen=True)
class Variant:
    """A further preset.

    scenes   in which it runs: a condition of scenarios/engines.py
    of       preset that it replaces in short tables where the preset's figures do not compare
    metrics  in which it does
    """

    scenes: str
    of: str = ""
    metrics: tuple[str, ...] = ()


@dataclass(frozen=True)
class Issue:
    """Behaviour that explains large figures: found in a version on a date, in scenes (patterns)."""

    title: str
    cause: Literal["engine", "package", "adapter", "setting"]
    version: str
    date: str
    scenes: str
    text: str


@dataclass(frozen=True)
class About:
    """Facts on an engine.

    name            in files
    label           on pages
    colour, dark    of its marks on light and dark pages
    presets         in the order of tables; others are shown only on pages of scenes
    adapter         "module:class" behind the Engine protocol
    packages        distributions whose versions can change its figures
    extra           that installs them
    when_missing    hint that is shown where one of them is not installed
    reuses_process  flag: it leaves nothing behind in its process, so that one serves for many runs
    has_time_step   flag: it has a time step of its own, by an option "dt"; of others the frame is cut
    sleeps          flag: it puts resting bodies to sleep unless a scene forbids it
    baseline        flag: it handles no contact, and is ranked nowhere
    variants        further presets by name
    unsupported     features by the name that the adapter reports
    native          options of the adapter in the engine's own words, {} is the value; of a flag one for true and one for false
    alone           options that are all that changes in a preset
    loads           lines that load a preset, with {file}: of the scene in the engine's own words, {preset}, {scene}, {options}
    unlike          differences of scenes in this engine, a sentence each
    issues          known ones
    path            of the file; None where there is none
    """

    name: str
    label: str
    colour: Colour
    dark: Colour
    presets: tuple[str, ...]
    adapter: Annotated[str, r"[\w.]+:\w+"] = ""
    packages: tuple[str, ...] = ()
    extra: str = EXTRA
    when_missing: str = ""
    reuses_process: bool = False
    has_time_step: bool = False
    sleeps: bool = False
    baseline: bool = False
    variants: Mapping[str, Variant] = field(default_factory=dict)
    unsupported: Mapping[str, Unsupported] = field(default_factory=dict)
    native: Mapping[str, str | Mapping[str, str]] = field(default_factory=dict)
    alone: tuple[str, ...] = ()
    loads: str = ""
    unlike: tuple[str, ...] = ()
    issues: tuple[Issue, ...] = ()
    path: Path | None = field(default=None, metadata=NOT_IN_FILE)

    def in_own_words(self, options: Mapping[str, object]) -> list[str]:
        """Return a line per option in the engine's own words, a comment for one that has none."""
        lines = []
        for name, value in options.items():
            # a step to its last digit, as a fraction
            is_step = name == "dt" and isinstance(value, float) and isfinite(value)
            shown = str(Fraction(value).limit_denominator(100_000)) if is_step else str(value)
            words = self.native.get(name, f"# {name} = {{}}")
            lines.append(words.format(shown) if isinstance(words, str) else words[shown.lower()])
        return lines

    @property
    def both(self) -> str:
        """Its colour in CSS, for light and dark pages."""
        return f"light-dark({self.colour},{self.dark})"


@cache
def engines(folder: Path = FOLDER) -> Mapping[str, About]:
    """Return the engines in the folders of `folder`: the gated one first, baselines last. Raises InvalidFile."""
    listed = [_read(path) for path in sorted(folder.glob(f"*/{FILE}"))]
    listed.sort(key=lambda one: (one.name != GATED[0], one.baseline, one.name))
    for k, one in enumerate(listed):
        _distinct(one, listed[:k])
    return MappingProxyType({one.name: one for one in listed})


def _distinct(one: About, others: Iterable[About]) -> About:
    """Return an engine whose name and colours no other has. Raises InvalidFile."""
    for key in ("name", "colour", "dark"):
        for other in others:
            if getattr(one, key) == getattr(other, key):
                raise InvalidFile(f"{key} in {one.path}", getattr(one, key), f"another {key} than in {other.path}")
    return one


def joined() -> Mapping[str, str]:
    """Return the engines that join by an entry point: name -> "module:class"."""
    return _entries(tuple(sys.path))


@cache
def _entries(path: tuple[str, ...]) -> Mapping[str, str]:
    """Return the entry points of all packages on a path, looked for once."""
    return MappingProxyType({entry.name: entry.value for entry in metadata.entry_points(group=GROUP)})


def about(name: str) -> About:
    """Return the facts on an engine, made up for one that no file describes. Raises InvalidFile."""
    return engines()[name] if name in engines() else _of_joined(name, tuple(sys.path))


@cache
def _of_joined(name: str, path: tuple[str, ...]) -> About:
    adapter = _entries(path).get(name, "")
    for folder in _folders(adapter.partition(":")[0]):
        if (folder / FILE).is_file():
            return _distinct(_read(folder / FILE, name, adapter), engines().values())
    return About(name, name, *SPARE[sum(map(ord, name)) % len(SPARE)], ("default",), adapter)


def _folders(module: str) -> list[Path]:
    """Return the folders that may hold a module's file of facts; nothing of its package is imported."""
    top, *inner = module.split(".")
    try:
        spec = find_spec(top) if top else None
    except (ImportError, ValueError):
        return []
    places = [Path(place).joinpath(*inner) for place in (spec and spec.submodule_search_locations) or ()]
    return [place if place.is_dir() else place.parent for place in places]


def _read(path: Path, name: str = "", adapter: str = "") -> About:
    """Read a file of facts; `name` and `adapter` are those of an entry point. Raises InvalidFile."""
    engine = read(path, About)
    if name not in ("", engine.name):
        raise InvalidFile(f"name in {path}", engine.name, f"{name}, the name of the entry point")
    if not engine.presets:
        raise InvalidFile(f"presets in {path}", engine.presets, "one or more")
    if not engine.adapter and not adapter:
        raise InvalidFile(f"adapter in {path}", engine.adapter, "module:class")
    return replace(engine, path=path, adapter=adapter or engine.adapter)


def run_label(run: str) -> str:
    """Return "engine/preset" as pages call it: without the preset where the engine has one in tables."""
    name, _, preset = run.partition("/")
    one = about(name)
    return one.label if one.presets == (preset,) else f"{one.label} {preset}"


def main_runs() -> tuple[str, ...]:
    """Return "engine/preset" of all rows of short tables, in their order."""
    return tuple(f"{one.name}/{preset}" for one in engines().values() for preset in one.presets)
