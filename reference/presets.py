"""Settings of a reference engine: named values with the reason for each, overridden by name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from avatarsim.engine import Settings
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from runfiles.naming import TUNED

Value = bool | int | float | str | tuple[float, ...] | None
"""Types of a setting."""


ONE_SCENE = "for this scene only: "
"""Beginning of the reason of a setting that was chosen for one scene."""


class Kind(Enum):
    """Kind of a scene: it has bodies that bounce, that slide and rest but never bounce, that are driven, or both."""

    BOUNCING = "bouncing"
    RESTING = "resting"
    DRIVEN = "driven"
    MIXED = "mixed"


@dataclass(frozen=True)
class Chosen:
    """One setting and why it has this value."""

    value: Value
    reason: str


Preset = Mapping[str, Chosen]


class Options(dict[str, Chosen]):
    """Settings in force by name."""

    def number(self, name: str) -> float:
        """Return a setting that is a number."""
        return float(np.asarray(self[name].value, dtype=np.float64))

    def flag(self, name: str) -> bool:
        """Return a setting that is true or false."""
        return bool(self[name].value)

    def word(self, engine: str, name: str, known: Sequence[str]) -> str:
        """Return a setting that is one of `known`; raises UnknownName."""
        value = str(self[name].value)
        if value not in known:
            raise UnknownName(f"option {name} of {engine}", value, known)
        return value

    def step_count(self, engine: str, dt: float) -> int:
        """Return the whole number of steps nearest to the setting `dt` of a frame of `dt` seconds; raises InvalidInput."""
        if not (np.isfinite(dt) and dt > 0.0):
            raise InvalidInput("frame time [s]", dt, "finite and above 0")
        if not self.number("dt") > 0.0:
            raise InvalidInput(f"option dt of {engine}", self["dt"].value, "seconds above 0")
        return max(1, round(dt / self.number("dt")))

    def as_run(self, preset: str, optimises: Mapping[str, str], better: Sequence[str], step: float, count: int
               ) -> dict[str, object]:
        """Return every setting as (value, reason), the purpose of the preset, the step [s], and of "tuned" better ones."""
        run: dict[str, object] = {name: (chosen.value, chosen.reason) for name, chosen in self.items()}
        run["optimises"] = (optimises[preset], "the purpose of this preset")
        if preset == TUNED:
            run["better elsewhere"] = (". ".join(better), "settings that are better in something else, and their cost")
        return run | {"dt as run": (step, cut_into(count))}


def cut_into(count: int) -> str:
    """Return the reason for the step: a frame is cut into `count` of them."""
    return f"{count} step{'' if count == 1 else 's'} per frame: the nearest whole number"


def kind_of(scene: Scene) -> Kind:
    """Return simulated bodies only (of pairs that bounce, or of none), driven ones only, or both."""
    if not scene.avatars:
        return Kind.BOUNCING if scene.effects.restitution else Kind.RESTING
    return Kind.MIXED if any(role is Role.SIMULATED for role in scene.roles) else Kind.DRIVEN


def in_force(engine: str, presets: Mapping[str, Preset], settings: Settings) -> Options:
    """Return the preset that `settings` names, with its options in place; typed errors for names and values that are
    unknown."""
    if settings.preset not in presets:
        raise UnknownName(f"preset of {engine}", settings.preset, presets)
    chosen = Options(presets[settings.preset])
    for name, value in settings.options.items():
        if name not in chosen:
            raise InvalidInput(f"option of {engine}", name, "one of " + ", ".join(sorted(chosen)))
        chosen[name] = Chosen(_like(engine, name, chosen[name].value, value), "set by hand")
    return chosen


def of_one_scene(preset: Preset) -> Preset:
    """Return settings that are the best of one scene and of no other, marked so in their reasons."""
    return {name: Chosen(chosen.value, f"{ONE_SCENE}{chosen.reason}") for name, chosen in preset.items()}


def _like(engine: str, name: str, default: Value, value: object) -> Value:
    """Return `value` in the type of the setting's default; settings whose default is None take
    numbers."""
    thing = f"option {name} of {engine}"
    if isinstance(default, bool):
        if isinstance(value, bool):
            return value
        raise InvalidInput(thing, value, "true or false")
    if isinstance(default, str):
        if isinstance(value, str):
            return value
        raise InvalidInput(thing, value, f"a word such as {default!r}")
    try:
        numbers = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(thing, value, "numbers") from None
    if not np.isfinite(numbers).all():
        raise InvalidInput(thing, value, "finite numbers")
    if isinstance(default, tuple):
        if numbers.shape != (len(default),):
            raise InvalidInput(thing, value, f"{len(default)} numbers")
        return tuple(float(number) for number in numbers)
    if numbers.shape != ():
        raise InvalidInput(thing, value, "one number")
    return int(numbers) if isinstance(default, int) else float(numbers)
