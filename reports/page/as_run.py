"""Settings of every engine as they were in force in one scene, and the file in which they stand in the engine's own words."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from reports.reading.load import Results
from runfiles.native_files import steps_written, written


@dataclass(frozen=True)
class AsRun:
    """One run in one scene: `settings` as name -> (value, reason or ""), `native` the path of its file as the page of a scene
    links it, "" if its engine gave none; `steps`: of what it was told in every step and of the program that plays it."""

    run: str
    version: str
    settings: Mapping[str, tuple[str, str]]
    native: str
    steps: tuple[str, ...] = ()


def as_run(run_dir: Path, results: Results, scene: str, seed: int) -> tuple[AsRun, ...]:
    """Every run of the scene that told its settings, in the order of the results; with several seeds the files are of `seed`."""
    found: dict[str, AsRun] = {}
    for note in results.engines:
        if note.scenario == scene and note.settings and note.run not in found:
            path = written(run_dir, scene, note.run, seed)
            found[note.run] = AsRun(note.run, note.version, note.settings, f"../{path}" if path else "",
                                    tuple(f"../{name}" for name in steps_written(run_dir, scene, note.run, seed)))
    return tuple(found.values())
