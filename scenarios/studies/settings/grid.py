"""Settings of engines that are swept, each named by its difference from a preset beneath: `reference/*/sweep.toml`."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from typing import Annotated

from avatarsim.errors import InvalidFile
from avatarsim.scene.effects import Effects
from avatarsim.scene.scene import Scene
from reference.presets import Kind, kind_of
from runfiles.engines import about
from runfiles.typed_toml import read
from scenarios.run.own_settings import OwnSettings

EVERYWHERE = tuple(Kind)
FILE = "sweep.toml"
EFFECTS = tuple(effect.name for effect in fields(Effects))
Effect = Annotated[str, EFFECTS]
Count = Annotated[int, range(1, 1_000_000)]


@dataclass(frozen=True)
class Setting:
    """One point of an engine's knobs.

    `base` is the preset beneath, `options` override it, `narrow` leaves out effects of the scene (ours only), `cut` advances each
    rendered frame in so many parts (for engines whose step is the frame). `kinds` are the scenes in which it changes anything,
    `calls` effects that such a scene must need.
    """

    engine: str
    name: str
    base: str
    options: Mapping[str, object] = field(default_factory=dict)
    narrow: tuple[str, ...] = ()
    cut: int = 1
    kinds: tuple[Kind, ...] = EVERYWHERE
    calls: tuple[str, ...] = ()

    @property
    def is_preset(self) -> bool:
        """Return True if it is the preset beneath as it comes."""
        return self.name == self.base

    @property
    def slug(self) -> str:
        """The name as part of a file name."""
        return self.name.replace("/", "_").replace(" ", ".")

    @property
    def run(self) -> str:
        """Engine and setting as tables name them."""
        return f"{self.engine}/{self.name}"


@dataclass(frozen=True)
class Entry:
    """One setting of a file, or one for each of its steps; see `Setting`.

    base    the preset beneath; by default the first word of the name
    steps   steps a second, in place of a name
    short   flag: a short sweep takes it
    groups  tables of options
    """

    name: str = ""
    base: str = ""
    steps: tuple[Count, ...] = ()
    short: bool = True
    options: Mapping[str, object] = field(default_factory=dict)
    groups: tuple[str, ...] = ()
    narrow: tuple[Effect, ...] = ()
    cut: Count = 1
    kinds: tuple[Kind, ...] = EVERYWHERE
    calls: tuple[Effect, ...] = ()


@dataclass(frozen=True)
class Grid:
    """A file: its settings in the order in which a short sweep spends its time, and groups of options by name."""

    sweep: tuple[Entry, ...] = ()
    groups: Mapping[str, Mapping[str, object]] = field(default_factory=dict)


def _grid(engine: str) -> tuple[tuple[Setting, bool], ...]:
    """Return the settings that an engine's file lists, each with its flag `short`. Raises InvalidFile."""
    path = about(engine).path
    return () if path is None else _read(engine, path.with_name(FILE))


@cache
def _read(engine: str, path: Path) -> tuple[tuple[Setting, bool], ...]:
    grid = read(path, Grid) if path.is_file() else Grid()
    settings = list[tuple[Setting, bool]]()
    for k, row in enumerate(grid.sweep):
        base = row.base or row.name.partition(" ")[0]
        if not base or bool(row.name) == bool(row.steps):
            raise InvalidFile(f"sweep[{k}] in {path}", row.name, "a name, or steps and a base")
        options = dict(row.options)
        for group in row.groups:
            if group not in grid.groups:
                raise InvalidFile(f"sweep[{k}].groups in {path}", group, f"one of {', '.join(grid.groups)}")
            options |= grid.groups[group]
        for name, step in [(f"{base} dt=1/{rate}", {"dt": 1.0 / rate}) for rate in row.steps] or [(row.name, {})]:
            setting = Setting(engine, name, base, step | options, row.narrow, row.cut, row.kinds, row.calls)
            settings.append((setting, row.short))
    return tuple(settings)


def settings_of(engine: str, presets: Iterable[str], own: Iterable[OwnSettings] = ()) -> tuple[Setting, ...]:
    """Return the settings of an engine that are swept: its grid, or its presets where it has none, and a reader's own rows."""
    known = [setting for setting, _ in _grid(engine)] or [Setting(engine, preset, preset) for preset in presets]
    rows = (Setting(engine, row.name, row.base, dict(row.options)) for row in own if row.engine == engine)
    return (*known, *rows)


def short_order(engine: str, presets: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the settings that a short sweep takes, in the order in which it spends its time: those of the grid
    that span cost and accuracy, presets first, or the presets where there is no grid."""
    return tuple(setting.name for setting, short in _grid(engine) if short) or tuple(presets)


def applicable(setting: Setting, scene: Scene) -> bool:
    """Return True if the setting can change anything in this scene."""
    derived = scene.derived_effects
    return kind_of(scene) in setting.kinds and all(getattr(derived, effect) for effect in (*setting.narrow, *setting.calls))
