"""A scene as a simulator's own user would write it: MJCF, or the calls of its Python interface, kept beside the recordings.

An engine that can tell has a method `native`; the protocol of engines does not ask for it.
"""

import gzip
from pathlib import Path
from typing import Protocol, runtime_checkable

from reference.presets import COMPILED as COMPILED
from scenarios.files import write_whole
from scenarios.job import Job

FOLDER = "native"
"""Where these files lie in a run's folder."""


@runtime_checkable
class TellsNative(Protocol):
    """An engine that can say what it loaded in the words of the simulator behind it."""

    def native(self) -> tuple[str, str]:
        """After `load`: the ending that such a text has as a file, and the text."""


def write(engine: object, folder: Path, job: Job) -> None:
    """Write what `engine` has loaded for `job` below a run's `folder`, compressed; nothing for an engine that cannot tell."""
    if isinstance(engine, TellsNative):
        ending, text = engine.native()
        # without a time in it, so that equal texts are equal files
        data = gzip.compress(text.encode("utf-8"), mtime=0)
        write_whole(folder / FOLDER / f"{job.stem}.{ending}.gz", lambda file: file.write(data))


def written(folder: Path, scene: str, run: str, seed: int) -> str:
    """Path, below a run's `folder`, of what was written for that scene, run and seed; "" if nothing was."""
    engine, _, preset = run.partition("/")
    stem = Job(scene, engine, preset, seed).stem
    found = sorted((folder / FOLDER).glob(f"{stem}.*.gz"))
    return f"{FOLDER}/{found[0].name}" if found else ""
