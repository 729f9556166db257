"""Seconds before the first answer: compiling the collide room from nothing, and starting the engine with everything compiled."""

import os
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
COMPILE_GOAL, START_GOAL = 10.0, 2.0
"""Goals [s]: first compile of the room below the one, cached start of the whole engine below the other."""

STARTS = 3
"""Cached starts measured, after one that is not: it fills the disk's cache, and compiles what nobody has compiled yet."""

PATIENCE = 300.0
"""Longest a child may take [s]; beyond, the figure is missing."""

COMPILE = """
import time
import numpy as np
from avatarsim.collide.coherent import signed_distance_coherent
from avatarsim.collide.global_depth import global_depth
from avatarsim.collide.pair_memory import make_pair_memory
from avatarsim.collide.scratch import make_scratch
from avatarsim.collide.signed_distance import separated_beyond, signed_distance
from avatarsim.collide.support import gap_along
from avatarsim.collide.sweep import sweep_and_prune
from avatarsim.collide.sweep_memory import make_sweep_memory
from avatarsim.world.pair_filter import OPEN, pair_filter
from avatarsim.world.shapes import POINTS, make_shapes

begun, worked = time.perf_counter(), time.process_time()
corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
vertices = np.ascontiguousarray(np.vstack([corners, corners + 0.5]))
shapes = make_shapes([POINTS, POINTS], [0, 8, 16], [0.0, 0.0], [2.0, 2.0])
scratch, up = make_scratch(), (0.0, 0.0, 1.0)
signed_distance(vertices, shapes, 0, 1, up, scratch)
separated_beyond(vertices, shapes, 0, 1, up, 0.0, scratch)
gap_along(vertices, shapes, 0, 1, up)
signed_distance_coherent(vertices, shapes, 0, 1, 1.0, scratch, make_pair_memory(1), 0)
global_depth(vertices, shapes, np.array([0, 1, 2]), 0, 1, scratch)
boxes = np.array([[0.0, 0.0, 0.0, 1.0, 1.0, 1.0], [0.5, 0.5, 0.5, 2.0, 2.0, 2.0]])
sweep_and_prune(boxes, pair_filter([OPEN, OPEN]), make_sweep_memory(2, 4), np.zeros((4, 2), dtype=np.int64))
print(time.perf_counter() - begun, time.process_time() - worked)
"""
"""Every entry of the room called once; the time without imports."""

START = """
from avatarsim.compile_ahead import part_scene
from avatarsim.engine import Settings
from avatarsim.simulator import AvatarsimEngine

scene, preset = part_scene("together")
engine = AvatarsimEngine()
engine.load(scene, Settings(preset=preset), 1.0 / 60.0)
engine.advance(scene.first_sample, 1.0 / 60.0)
"""
"""A program that shows one frame of avatar, floor and ball: interpreter, imports, load, first frame."""


@dataclass(frozen=True)
class StartUp:
    """Seconds; nan where a child failed, and then `note` says how.

    compile_s      compiling the collide room from an empty cache, one process, without imports: wall time
    compile_cpu_s  the same as time of the processor: what the wall time is on a machine that does nothing else
    start_s        median wall time of a process that imports the engine, loads a scene and shows one frame, all compiled
    """

    compile_s: float
    compile_cpu_s: float
    start_s: float
    note: str = ""

    def as_dict(self) -> dict[str, object]:
        """For JSON, goals beside it."""
        return asdict(self) | {"compile_goal_s": COMPILE_GOAL, "start_goal_s": START_GOAL}

    def __str__(self) -> str:
        """Two lines for the terminal."""
        return (
            f"first compile of the collide room, empty cache, one process: {self.compile_s:.1f} s, "
            f"of the processor {self.compile_cpu_s:.1f} s ({_word(self.compile_s, COMPILE_GOAL)})\n"
            f"cached start of the whole engine, import to first frame: {self.start_s:.2f} s ({_word(self.start_s, START_GOAL)})"
            + (f"\n{self.note}" if self.note else "")
        )


def _word(seconds: float, goal: float) -> str:
    return f"{'held' if seconds < goal else 'LOST'}, goal under {goal:g} s"


def measured() -> StartUp:
    """Both, in processes of their own."""
    notes: list[str] = []
    compiled, worked, starts = np.nan, np.nan, []
    try:
        with tempfile.TemporaryDirectory() as folder:
            said, _ = _child(COMPILE, {"NUMBA_CACHE_DIR": folder, "NUMBA_DISABLE_JIT": "0"})
            compiled, worked = (float(word) for word in said.split())
    except (subprocess.SubprocessError, OSError, ValueError) as error:
        notes.append(f"compile: {_why(error)}")
    try:
        starts = [_child(START, {"NUMBA_DISABLE_JIT": "0"})[1] for _ in range(1 + STARTS)][1:]
    except (subprocess.SubprocessError, OSError) as error:
        notes.append(f"start: {_why(error)}")
    return StartUp(compiled, worked, float(np.median(starts)) if starts else np.nan, "; ".join(notes))


def _why(error: Exception) -> str:
    """How a child failed, in a line; without its program, which is all that subprocess would say."""
    if isinstance(error, subprocess.TimeoutExpired):
        return f"not done after {error.timeout:g} s; is everything compiled?"
    if isinstance(error, subprocess.CalledProcessError):
        return f"code {error.returncode}: {(str(error.stderr).strip().splitlines() or ['no word'])[-1]}"
    return f"{type(error).__name__}: {error}"


def _child(program: str, environment: dict[str, str]) -> tuple[str, float]:
    """What a program prints, and its wall time [s] with the interpreter's own start."""
    begun = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, env=os.environ | environment, capture_output=True, text=True, check=True,
        timeout=PATIENCE,
    )
    return done.stdout.strip(), time.perf_counter() - begun
