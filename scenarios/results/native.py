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
from runfiles.native_files import FOLDER, REPLAY, STEPS
from scenarios.job import Job

PROGRAM = '''"""python replay.py MODEL.xml.gz MODEL.steps.npz: plays what the tracker told; prints depth and time."""
import gzip, sys, time
import mujoco, numpy as np
model = mujoco.MjModel.from_xml_string(gzip.open(sys.argv[1]).read().decode())
data, told, deepest, spent = mujoco.MjData(model), np.load(sys.argv[2]), 0.0, []
mujoco.mj_resetDataKeyframe(model, data, 0)
for places, turns, controls in zip(told["mocap_pos"], told["mocap_quat"], told["ctrl"]):
    data.mocap_pos[:], data.mocap_quat[:], data.ctrl[:] = places, turns, controls
    begun = time.perf_counter(); mujoco.mj_step(model, data); spent.append(time.perf_counter() - begun)
    deepest = max([deepest, *(-data.contact.dist)])  # [m], of MuJoCo's own contacts, sub-steps included
frames = np.reshape(spent, (-1, int(told["steps_per_frame"]))).sum(axis=1)
print(f"deepest {1e3 * deepest:.6g} mm; median frame {1e6 * np.median(frames):.4g} us; qpos ends at {data.qpos}")
'''
"""Ten lines of Python that need MuJoCo and numpy alone."""

Array = NDArray[np.float64]


@runtime_checkable
class TellsSteps(Protocol):
    """An engine that can keep what it is told in every step."""

    def keep_steps(self) -> None:
        """After `load`: keep it from now on."""

    def steps_told(self) -> Mapping[str, Array]:
        """What was kept, by name; empty if nothing was told."""


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
    told = engine.steps_told() if isinstance(engine, TellsSteps) else {}
    if told:
        packed = io.BytesIO()
        np.savez_compressed(packed, allow_pickle=False, **told)
        write_whole(folder / FOLDER / f"{job.stem}.{STEPS}", lambda file: file.write(packed.getvalue()))
        write_whole(folder / FOLDER / REPLAY, lambda file: file.write(PROGRAM.encode("utf-8")))


