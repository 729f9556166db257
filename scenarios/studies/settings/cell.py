"""One engine with one setting in one scene, and its measured values: errors, and time."""

from dataclasses import dataclass
from functools import cache, cached_property

from avatarsim.scene.scene import Scene
from runfiles.naming import stem
from scenarios import catalog
from scenarios.job import CATALOGUE, Job
from scenarios.studies.settings import finer
from scenarios.studies.settings.grid import Setting

TIMED = 240
"""Rendered frames that the long sweep times, four seconds: all of its scenes come into contact within them."""


@dataclass(frozen=True, eq=False)
class Cell:
    """One point of the sweep, before anything is known of it."""

    scenario: str
    setting: Setting
    seed: int = 0
    full: bool = False
    frames: int | None = None
    catalogue: str = CATALOGUE
    most: int = TIMED
    """Rendered frames that are timed at most."""

    @cached_property
    def job(self) -> Job:
        """Return the job that the harness runs."""
        s, cut = self.setting, self.setting.cut
        name, catalogue = (self.scenario, self.catalogue) if cut == 1 else (finer.name_of(self.scenario, cut), finer.__name__)
        frames = None if self.frames is None else self.frames * cut
        return Job(name, s.engine, s.slug, self.seed, self.full, frames, s.base, s.options, catalogue, s.narrow)

    @property
    def timed_frames(self) -> int:
        """Frames that are timed, as the engine is advanced."""
        limit = self.most if self.frames is None else min(self.most, self.frames)
        return self.setting.cut * min(limit, catalog.get(self.scenario).as_run(self.full).frames)

    @property
    def recorded_as(self) -> str:
        """The stem under which the run's own passes know it: presets and the user's rows only."""
        return stem(self.scenario, self.setting.engine, self.setting.name, self.seed)

    @property
    def scene(self) -> Scene:
        """Its scene, at the length that is run."""
        return _scene(self.scenario, self.full)


@cache
def _scene(scenario: str, full: bool) -> Scene:
    return catalog.get(scenario).as_run(full).build()
