"""Jobs and their outcomes; both travel between processes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from avatarsim.engine import Engine, Settings
from avatarsim.errors import UnknownName
from runfiles.engines import about
from runfiles.naming import stem
from scenarios.measure.value import Value

State = Literal["measured", "crashed", "not-measured", "cannot-say", "refused"]

CATALOGUE = "scenarios.catalog"
"""Module whose `get(name)` gives the scenarios."""


@dataclass(frozen=True)
class Job:
    """One engine with one preset in one scenario with one seed; small, since it is sent to a process.

    preset         its name in every table
    frames         most frames; None: all
    base, options  of settings that a user added: the engine's own preset, and values that override it
    narrow, force  effects that are switched off and on, in addition to those of the scene's author
    """

    scenario: str
    engine: str
    preset: str
    seed: int = 0
    full: bool = False
    frames: int | None = None
    base: str = ""
    options: Mapping[str, object] = field(default_factory=dict)
    catalogue: str = CATALOGUE
    narrow: tuple[str, ...] = ()
    force: tuple[str, ...] = ()

    @property
    def stem(self) -> str:
        """Name of its recording, without the ending."""
        return stem(self.scenario, self.engine, self.preset, self.seed)

    @property
    def run(self) -> str:
        """Engine and preset as tables name them."""
        return f"{self.engine}/{self.preset}"

    def settings(self, engine: Engine, *, inside: bool = False, stages: bool = False) -> Settings:
        """Return the settings to load `engine` with. Raises UnknownName for a preset that it does not have."""
        preset = self.base or self.preset
        offered = (*engine.presets, *about(self.engine).variants)
        if preset not in offered:
            raise UnknownName(f"preset of engine {self.engine}", preset, offered)
        return Settings(preset, self.options, self.seed, record_inside=inside, time_stages=stages)


@dataclass(frozen=True, eq=False)
class Outcome:
    """Result of a job.

    note           reason of a state other than measured
    values, notes  by metric
    overlap_m      of every state shown [m]
    about          version, settings and unsupported features of the engine, lapsed promises of the scene
    hashes         of every state shown
    frame_seconds  rough time of a frame [s]
    resting        flag of every frame: nothing moves
    """

    job: Job
    state: State
    note: str = ""
    frames: int = 0
    values: Mapping[str, Value] = field(default_factory=dict)
    notes: Mapping[str, str] = field(default_factory=dict)
    overlap_m: tuple[float, ...] = ()
    about: Mapping[str, object] = field(default_factory=dict)
    recording: Path | None = None
    hashes: tuple[str, ...] = ()
    frame_seconds: float = 0.0
    resting: tuple[bool, ...] = ()


def reuses_process(job: Job) -> bool:
    """Return whether the next job may run in the process of this one."""
    return about(job.engine).reuses_process
