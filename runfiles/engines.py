"""Facts on engines: one `reference/*/about.toml` each."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import MappingProxyType

from runfiles.naming import GATED

FOLDER = Path(__file__).parent.parent / "reference"

SPARE = (("#b0498d", "#f08fce"), ("#9a7400", "#e6c04a"), ("#3c8fb3", "#7fd0ef"), ("#7a5cc4", "#b7a0ff"))
"""Colours, light and dark, of engines that no file describes: those that join through the entry-point group."""


@dataclass(frozen=True)
class Unsupported:
    """A feature that is not set up in an engine.

    metrics  that do not compare the engine in scenes with the feature
    lacks    "engine" or "adapter"
    presets  that lack it; empty for all
    """

    metrics: tuple[str, ...]
    lacks: str
    presets: tuple[str, ...] = ()


@dataclass(frozen=True)
class Issue:
    """Behaviour that explains large figures: found in a version on a date, in scenes (patterns)."""

    title: str
    cause: str
    version: str
    date: str
    scenes: str
    text: str


@dataclass(frozen=True)
class About:
    """Facts on an engine for tables and charts.

    name         in files
    label        on pages
    colour, dark  of its marks on light and dark pages
    presets      in the order of tables; others are shown only on pages of scenes
    sleeps       flag: it puts resting bodies to sleep unless a scene forbids it
    baseline     flag: it handles no contact, and is ranked nowhere
    unsupported  features by the name that the adapter reports
    native       options of the adapter in the engine's own words, {} is the value; of a flag one for each value
    alone        options that are all that changes in a preset
    unlike       differences of scenes in this engine, a sentence each
    issues       known ones
    """

    name: str
    label: str
    colour: str
    dark: str
    presets: tuple[str, ...]
    sleeps: bool = False
    baseline: bool = False
    unsupported: Mapping[str, Unsupported] = field(default_factory=dict)
    native: Mapping[str, str | Mapping[str, str]] = field(default_factory=dict)
    alone: tuple[str, ...] = ()
    unlike: tuple[str, ...] = ()
    issues: tuple[Issue, ...] = ()

    def in_own_words(self, options: Mapping[str, object]) -> list[str]:
        """Return a line per option in the engine's own words, a comment for one that has none."""
        lines = []
        for name, value in options.items():
            # a step to its last digit, as a fraction
            shown = str(Fraction(value).limit_denominator(100_000)) if name == "dt" and isinstance(value, float) else str(value)
            words = self.native.get(name, f"# {name} = {{}}")
            lines.append(words.format(shown) if isinstance(words, str) else words[shown.lower()])
        return lines

    @property
    def both(self) -> str:
        """Its colour in CSS, for light and dark pages."""
        return f"light-dark({self.colour},{self.dark})"


@cache
def engines() -> Mapping[str, About]:
    """Return the engines that files describe: the gated one first, baselines last."""
    found = [_about(tomllib.loads(path.read_text(encoding="utf-8"))) for path in sorted(FOLDER.glob("*/about.toml"))]
    found.sort(key=lambda one: (one.name != GATED[0], one.baseline, one.name))
    return MappingProxyType({one.name: one for one in found})


def _about(data: Mapping[str, object]) -> About:
    entries = dict(data)
    lacking = {
        name: Unsupported(tuple(one["metrics"]), one["lacks"], tuple(one.get("presets", ())))
        for name, one in dict(entries.pop("unsupported", {})).items()  # type: ignore[call-overload]
    }
    issues = tuple(Issue(**one) for one in entries.pop("issues", ()))  # type: ignore[attr-defined]
    lists = {name: tuple(entries.pop(name, ())) for name in ("presets", "unlike", "alone")}  # type: ignore[call-overload]
    return About(**entries, **lists, unsupported=lacking, issues=issues)  # type: ignore[arg-type]


def about(name: str) -> About:
    """Return the facts on an engine, made up for one that no file describes."""
    if name in engines():
        return engines()[name]
    colour, dark = SPARE[sum(map(ord, name)) % len(SPARE)]
    return About(name, name, colour, dark, ("default",))


def run_label(run: str) -> str:
    """Return "engine/preset" as pages call it: without the preset where the engine has one in tables."""
    name, _, preset = run.partition("/")
    one = about(name)
    return one.label if len(one.presets) == 1 and preset == one.presets[0] else f"{one.label} {preset}"


def main_runs() -> tuple[str, ...]:
    """Return "engine/preset" of all rows of short tables, in their order."""
    return tuple(f"{one.name}/{preset}" for one in engines().values() for preset in one.presets)
