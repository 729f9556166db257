"""Seconds before the first answer: compiling the collide room from nothing, and starting the engine with everything compiled."""

import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
COMPILE_GOAL, START_GOAL = 10.0, 2.0
"""Goals [s]: first compile of the room below the one, cached start of the whole engine below the other."""

STARTS = 3
"""Cached starts measured, after one that is not: it fills the disk's cache, and compiles what is not compiled yet."""

PATIENCE = 300.0
"""Longest a child may take [s]; beyond, the figure is missing."""

PREPARE = """
import gc
import time
import numpy as np
from avatarsim.collision.warm_query import signed_distance_coherent
from avatarsim.paper.push_apart import global_depth
from avatarsim.collision.warm_start import make_pair_memory
from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.support import gap_along
from avatarsim.collision.broad_phase import sweep_and_prune
from avatarsim.collision.grid import make_sweep_memory
from avatarsim.model.geometry import OPEN, pair_filter
from avatarsim.model.geometry import POINTS, make_shapes

gc.disable()
corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
vertices = np.ascontiguousarray(np.vstack([corners, corners + 0.5]))
shapes = make_shapes([POINTS, POINTS], [0, 8, 16], [0.0, 0.0], [2.0, 2.0])
scratch, up = make_scratch(), (0.0, 0.0, 1.0)
boxes = np.array([[0.0, 0.0, 0.0, 1.0, 1.0, 1.0], [0.5, 0.5, 0.5, 2.0, 2.0, 2.0]])
begun, worked = time.time(), time.process_time()
"""
ENTRIES = (
    """signed_distance(vertices, shapes, 0, 1, up, scratch)
gap_along(vertices, shapes, 0, 1, up)
global_depth(vertices, shapes, np.array([0, 1, 2]), 0, 1, scratch)
""",
    """sweep_and_prune(boxes, pair_filter([OPEN, OPEN]), make_sweep_memory(2, 4), np.zeros((4, 2), dtype=np.int64))
signed_distance_coherent(vertices, shapes, 0, 1, 1.0, scratch, make_pair_memory(1), 0)
""",
)
"""Every entry of the room called once, dealt out to as many processes as `python -m avatarsim` uses: what one compiles the
others find."""

SAY = "print(begun, time.time(), time.process_time() - worked)"

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

    compile_s      compiling the collide room from an empty cache, two processes, without imports: wall time
    compile_cpu_s  the same as time of the processor, both together
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
            f"first compile of the collide room, empty cache, two processes: {self.compile_s:.1f} s, "
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
        compiled, worked = compiling()
    except (subprocess.SubprocessError, OSError, ValueError) as error:
        notes.append(f"compile: {_why(error)}")
    try:
        starts = [_child(START, {"NUMBA_DISABLE_JIT": "0"})[1] for _ in range(1 + STARTS)][1:]
    except (subprocess.SubprocessError, OSError) as error:
        notes.append(f"start: {_why(error)}")
    return StartUp(compiled, worked, float(np.median(starts)) if starts else np.nan, "; ".join(notes))


def compiling() -> tuple[float, float]:
    """Wall time from the first process's begin to the last one's end, and time of the processor of all [s]."""
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(len(ENTRIES)) as at_once:
        environment = {"NUMBA_CACHE_DIR": folder, "NUMBA_DISABLE_JIT": "0"}
        children = [at_once.submit(_child, PREPARE + entries + SAY, environment) for entries in ENTRIES]
        said = np.array([[float(word) for word in child.result()[0].split()] for child in children])
    return float(said[:, 1].max() - said[:, 0].min()), float(said[:, 2].sum())


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
