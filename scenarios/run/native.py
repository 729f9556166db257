"""A scene as a simulator's own user would write it: MJCF, or the calls of its Python interface, kept beside the recordings.

An engine that can tell has a method `native`; the protocol of engines does not ask for it. One that is led step by step can keep
what it was told, so that a scene with an avatar can be played again without this project.
"""

import gzip
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from runfiles.files import write_whole
from runfiles.naming import COMPILED as COMPILED
from runfiles.naming import TUNED
from runfiles.native_files import FOLDER, STEPS, replay
from scenarios.job import Job

Array = NDArray[np.float64]


@runtime_checkable
class TellsSteps(Protocol):
    """An engine that can keep what it is told in every step."""

    def keep_steps(self) -> None:
        """After `load`: keep it from now on."""

    def steps_told(self) -> tuple[Mapping[str, Array], str]:
        """Return the steps by name, empty if there are none, and the text of a Python program that plays them."""


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


def keeps_steps(engine: object, job: Job, everyday: bool) -> bool:
    """Tell `engine` to keep what it is told, where that is written: everyday scenes, tuned. All scenes with an avatar would be
    150 MB of numbers that do not compress."""
    if not (everyday and job.preset == TUNED and isinstance(engine, TellsSteps)):
        return False
    engine.keep_steps()
    return True


def write_steps(engine: object, folder: Path, job: Job) -> None:
    """Write what `engine` was told in every step, and the program that plays it; nothing where nothing was told."""
    steps, program = engine.steps_told() if isinstance(engine, TellsSteps) else ({}, "")
    if steps:
        packed = io.BytesIO()
        np.savez_compressed(packed, allow_pickle=False, **steps)
        write_whole(folder / FOLDER / f"{job.stem}.{STEPS}", lambda file: file.write(packed.getvalue()))
        write_whole(folder / replay(job.engine), lambda file: file.write(program.encode("utf-8")))


