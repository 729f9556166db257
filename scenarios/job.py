"""Jobs and their outcomes: what is to be run, and what came of it; both travel between processes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import Literal

from avatarsim.engine import Engine, Settings
from avatarsim.errors import UnknownName
from avatarsim.scene.scene import Scene
from runfiles.engines import about
from runfiles.naming import stem
from scenarios.measure.value import Value
from scenarios.scenario import Motion, Scenario

State = Literal["measured", "crashed", "not-measured", "cannot-say", "refused"]

CATALOGUE = "scenarios.catalog"
"""Module whose `get(name)` gives the scenarios."""


@dataclass(frozen=True)
class Job:
    """One engine with one preset in one scenario with one seed.

    `preset` is the name in every table; `base` the engine's own preset beneath it and `options` what overrides it, both only for
    settings that a user added. `frames` cuts the run short. `narrow` and `force` switch effects of the scene off and on, beyond
    what its author did. Nothing here is large: a job is sent to a process of its own.
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

    def asked(self) -> tuple[Scenario, Scene, Motion]:
        """The scenario at the length that is run, its scene, its motion. Raises what the catalogue raises."""
        scenario: Scenario = import_module(self.catalogue).get(self.scenario).as_run(self.full)
        if self.frames is not None:
            scenario = replace(scenario, frames=min(self.frames, scenario.frames))
        built = scenario.build()
        scene = replace(built, narrow=(*built.narrow, *self.narrow), force=(*built.force, *self.force))
        return scenario, scene, scenario.motion(scene, self.seed)

    def settings(self, engine: Engine, *, inside: bool = False, stages: bool = False) -> Settings:
        """Settings to load `engine` with; UnknownName for a preset that it does not have."""
        preset = self.base or self.preset
        offered = (*engine.presets, *about(self.engine).variants)
        if preset not in offered:
            raise UnknownName(f"preset of engine {self.engine}", preset, offered)
        return Settings(preset, self.options, self.seed, record_inside=inside, time_stages=stages)


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of a job. `values` and `notes` by metric; `note` says why there are none; `overlap_m` per state shown;
    `about` is what the engine said of itself (version, settings, cannot_say); `hashes` the state hash of every state shown;
    `frame_seconds` roughly what a frame took [s]; `resting` of every frame whether nothing moved in it."""

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
