"""One engine with one setting in one scene, and what is measured of it: errors, and time."""

from dataclasses import dataclass, replace
from functools import cached_property
from zlib import crc32

from avatarsim.running.sources import cpu
from scenarios import catalog
from scenarios.job import CATALOGUE, Job
from scenarios.results.fingerprint import find, key_of, sources
from scenarios.studies.sweep import finer
from scenarios.studies.sweep.grid import Setting

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
        """What the harness runs."""
        s, cut = self.setting, self.setting.cut
        name, catalogue = (self.scenario, self.catalogue) if cut == 1 else (finer.name_of(self.scenario, cut), finer.__name__)
        frames = None if self.frames is None else self.frames * cut
        return Job(name, s.engine, s.slug, self.seed, self.full, frames, s.base, s.options, catalogue, s.narrow)

    @property
    def timed_frames(self) -> int:
        """Frames that are timed, as the engine is advanced."""
        limit = self.most if self.frames is None else min(self.most, self.frames)
        return self.setting.cut * min(limit, catalog.get(self.scenario).as_run(self.full).frames)

    @cached_property
    def key(self) -> str:
        """What its errors hang on."""
        return key_of(self.job)

    @cached_property
    def time_key(self) -> str:
        """What its times hang on: besides, the processor and how frames are timed."""
        about = f"{cpu()} {sources([find('scenarios.studies.sweep.clock')])}"
        return f"{key_of(replace(self.job, frames=self.timed_frames))}-{crc32(about.encode()):08x}"
