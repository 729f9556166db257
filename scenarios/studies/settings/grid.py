"""Settings of engines that are swept, each named by the difference from one of its engine's presets.

`reference/*/sweep.toml` has them: a list `sweep` of tables with the keys

    name    of the setting; its first word is the preset beneath, unless `base` names that
    steps   steps a second: a setting for each, in place of a name
    short   flag: a short sweep takes it (true)
    groups  names of tables [groups.NAME] of options

and those of `Setting`.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path

from avatarsim.scene.effects import Effects
from avatarsim.scene.scene import Scene
from reference.presets import Kind, kind_of
from runfiles.engines import about
from runfiles.toml_table import Table
from scenarios.running.own_settings import OwnSettings

EVERYWHERE = tuple(Kind)
FILE = "sweep.toml"
EFFECTS = tuple(effect.name for effect in fields(Effects))
KEYS = ("name", "base", "steps", "short", "options", "groups", "narrow", "cut", "kinds", "calls")


@dataclass(frozen=True)
class Setting:
    """One point of an engine's knobs.

    `base` is the preset beneath, `options` override it, `narrow` leaves out effects of the scene (ours only), `cut` advances each
    rendered frame in so many parts (for engines whose step is the frame). `kinds` are the scenes in which it changes anything,
    `calls` effects that such a scene must call for.
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
        """Whether it is the preset beneath as it comes."""
        return self.name == self.base

    @property
    def slug(self) -> str:
        """The name as part of a file name."""
        return self.name.replace("/", "_").replace(" ", ".")

    @property
    def run(self) -> str:
        """Engine and setting as tables name them."""
        return f"{self.engine}/{self.name}"


def _grid(engine: str) -> tuple[tuple[Setting, bool], ...]:
    """Return the settings that an engine's file lists, each with its flag `short`. Raises InvalidFile."""
    path = about(engine).path
    return () if path is None else _read(engine, path.with_name(FILE))


@cache
def _read(engine: str, path: Path) -> tuple[tuple[Setting, bool], ...]:
    if not path.is_file():
        return ()
    table = Table.read(path)
    groups = {name: one.rest() for name, one in table.tables("groups").items()}
    found = tuple(each for row in table.rows("sweep") for each in _settings(engine, row, groups))
    table.end(("sweep", "groups"))
    return found


def _settings(engine: str, row: Table, groups: Mapping[str, Mapping[str, object]]) -> Iterator[tuple[Setting, bool]]:
    """Yield the setting of a row, or one for each of its steps."""
    rates, short = row.numbers("steps"), row.flag("short", True)
    name = "" if rates else row.text("name")
    base = row.text("base", name.partition(" ")[0] or None)
    options = row.options("options")
    for group in row.texts("groups", groups):
        options |= groups[group]
    narrow, calls, cut = row.texts("narrow", EFFECTS), row.texts("calls", EFFECTS), row.whole("cut", 1)
    kinds = tuple(map(Kind, row.texts("kinds", [kind.value for kind in Kind]))) or EVERYWHERE
    row.end(KEYS)
    for named, step in [(f"{base} dt=1/{rate}", {"dt": 1.0 / rate}) for rate in rates] or [(name, {})]:
        yield Setting(engine, named, base, step | options, narrow, cut, kinds, calls), short


def settings_of(engine: str, presets: Iterable[str], own: Iterable[OwnSettings] = ()) -> tuple[Setting, ...]:
    """Return the settings of an engine that are swept: its grid, or its presets where it has none, and a reader's own rows."""
    known = [setting for setting, _ in _grid(engine)] or [Setting(engine, preset, preset) for preset in presets]
    rows = (Setting(engine, row.name, row.base, dict(row.options)) for row in own if row.engine == engine)
    return (*known, *rows)


def short_order(engine: str, presets: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the settings that a short sweep takes, in the order in which it spends its time: those of the grid that
    span cost and accuracy, presets first, or the presets where there is no grid."""
    return tuple(setting.name for setting, short in _grid(engine) if short) or tuple(presets)


def applicable(setting: Setting, scene: Scene) -> bool:
    """Whether the setting can change anything in this scene."""
    derived = scene.derived_effects
    return kind_of(scene) in setting.kinds and all(getattr(derived, effect) for effect in (*setting.narrow, *setting.calls))


def sleeps(setting: Setting, scene: Scene) -> bool:
    """Whether what rests in `scene` falls asleep with the setting: in ours by itself, in the others where they are told to."""
    if about(setting.engine).sleeps:
        return scene.derived_effects.sleeping and "sleeping" not in setting.narrow
    return setting.base == "sleeping" or bool(setting.options.get("sleep", False))
