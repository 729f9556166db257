"""Compile the kernels before they are needed: once per version of the sources, in parallel, with progress shown.

Progress and remaining time of a compilation, from the cache folder alone.

Every compiled kernel is a file on disk, and the kernels of the package are known from importing it. Files of an earlier
compilation count as done.
"""

import fcntl
import gc
import hashlib
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.connection import wait
from pathlib import Path
from typing import TextIO, cast

import numba
import numpy as np

from avatarsim.assets.models.coordinates import coordinates_of
from avatarsim.assets.models.model import Model
from avatarsim.assets.models.reach import Limb
from avatarsim.cleaning import Carried, Options, Shield, clean
from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance, signed_distance_up_to
from avatarsim.console import Progress
from avatarsim.engine import Settings
from avatarsim.errors import described, ended_by
from avatarsim.files import VARIABLE, make_private
from avatarsim.ik.bare_avatars import BareAvatars
from avatarsim.ik.goals import approach, make_goal_scratch, make_goals
from avatarsim.jit import places
from avatarsim.jit.first_compile import FIRST_COMPILE, seconds
from avatarsim.jit.kernel import config, is_stock
from avatarsim.jit.linking import KernelDispatcher
from avatarsim.jit.places import NAME, CannotKeep, Places, kept_kernels, missing
from avatarsim.jit.processor import Cpu, compiled_for, usable
from avatarsim.jit.source_hash import ROOT, kernel_folder
from avatarsim.many_worlds import advance_many
from avatarsim.model.world import build
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, SwingTwist
from avatarsim.scene.motion import Motion
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine


class Compiled:
    """The kernels of the package, and how many of them are compiled by now."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.wanted, self.clock = FIRST_COMPILE.own(), clock
        self.total = len(self.wanted)
        self.files, self.begun = self.entries(), clock()
        self.done_at_start = self.done()

    def entries(self) -> int:
        """Return files of compiled kernels: a kernel has one for each set of argument types."""
        return sum(kept_kernels(folder).total() for folder in {folder for folder, _ in self.wanted})

    def done(self) -> int:
        """Return kernels of which any file is on disk."""
        return self.total - missing(self.wanted)

    def left(self, done: int) -> float:
        """Return the time [s] until all are done at the rate so far; infinite at first."""
        new = done - self.done_at_start
        return (self.total - done) * (self.clock() - self.begun) / new if new else float("inf")

    def progress_text(self, done: int) -> str:
        """Return "so many of so many" and the time that is left; not before a tenth is done, for the first ones say little."""
        text = f"{done} of {self.total} kernels"
        is_known = done - self.done_at_start >= self.total // 10 and done < self.total
        return f"{text}, about {self.left(done):.0f} s left" if is_known else text


HARNESS = ROOT.parent / "reference" / "compile_ahead.py"
"""The file that compiles the kernels of the harness, in a checkout; a wheel has none."""

SOURCES = (ROOT / "compile_ahead.py", *([HARNESS] if HARNESS.is_file() else []))
"""Files that import, directly or not, every kernel that is compiled ahead."""

SHARES = (
    ("distance", "posture", "cleaning"),
    ("motion", "paper", "worlds", "goals", *(["harness"] if HARNESS.is_file() else [])),
)
"""Shares of the compilation, each in a process of its own, its parts one after the other; the shares take equally long.
Distances, which all other parts call, come first in one and a third of the way through the other: a process waits for a kernel
that another one is compiling. Posture and motion together compile all kernels of a scene with both; worlds compile the calls for
many engines at once and those between frames; cleaning proves ways between recorded postures; goals drag links. Memory grows by
half a gigabyte per process."""

PARTS = tuple(part for share in SHARES for part in share)
"""All parts."""

LIMITS = SwingTwist((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), 1.0, (-1.0, 1.0))
"""Limits of the ball joint in the scenes of the parts: checked at each load, which calls kernels."""

LOOK = 0.5
"""[s] between two looks at how far the processes are; longer: progress is shown late, shorter: it takes time from them."""

DT = 1.0 / 60.0
"""[s] frame time of the scenes of the parts."""


def part_scene(part: str) -> tuple[Scene, str]:
    """Return a small scene that calls every kernel of a part, or of posture and motion together, and the preset for it."""
    ball = (Piece(Sphere(0.05)),)
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "wood", (0.0, 0.0, -0.05))
    loose = simulated("ball", ball, "wood", solid(ball, 0.2), (0.0, 0.0, 0.2))
    links = (
        Link("root", None, Free(), ball, solid(ball, 1.0)),
        Link("limb", "root", Ball(LIMITS), ball, solid(ball, 1.0), anchor=(0.0, 0.0, 0.2)),
        Link("tip", "limb", Hinges((Hinge((1.0, 0.0, 0.0), -1.0, 1.0),)), ball, solid(ball, 1.0), anchor=(0.0, 0.0, 0.2)),
    )
    avatars = () if part == "motion" else (Avatar("a", links, chains=("tip",)),)
    start = rest(avatars)
    start.positions[:] = (0.5, 0.5, 0.5)
    bodies = (floor,) if part in ("posture", "distance", "cleaning") else (floor, loose)
    return Scene(part, bodies, avatars, start=start), "paper" if part == "paper" else "default"


def compile_part(part: str) -> None:
    """Load the part's scene and run two frames of it; kernels compiled on the way are kept on disk."""
    # The compiler makes and keeps millions of objects: looking through them for rings of garbage costs it a tenth of its time.
    gc.disable()
    if part in WITHOUT_FRAMES:
        WITHOUT_FRAMES[part]()
        return
    scene, preset = part_scene(part)
    with AvatarsimEngine() as engine:
        engine.load(scene, Settings(preset=preset), DT)
        first = scene.first_sample
        for k in range(1, 3):
            lower = first.positions - np.array([0.0, 0.0, 0.3 * k])
            sample = TrackerSample(DT * k, lower, first.rotations, first.angles)
            if part == "worlds":
                advance_many([engine], [sample], DT, threads=1)
            else:
                engine.advance(sample, DT)
        if part == "posture":
            engine.put(first)
            # in the floor, and so at the nearest free posture
            engine.put(replace(first, positions=first.positions - np.array([0.0, 0.0, 0.5])))
        if part in ("posture", "worlds", "paper"):
            call_between_frames(engine, scene)


def call_between_frames(engine: AvatarsimEngine, scene: Scene) -> None:
    """Call everything that a program may call between two frames, and load the scene without removal of overlaps."""
    engine.contacts(1.0)
    engine.advance(None, DT)
    engine.advance(scene.first_sample, DT)
    engine.restore(engine.snapshot())
    engine.change(scene)
    engine.reset()
    engine.load(replace(scene, narrow=("overlap_removal",)), Settings(), DT)


def compile_share(share: tuple[str, ...], only: Path | None = None) -> None:
    """Compile some parts, one after the other, in a process that does nothing else.

    Kernels are read from and kept in the folder `only`, if that is given. If they cannot be kept the process ends with an error,
    for then there is no use in compiling.
    """
    places.use_places(Places(only, required=True))
    FIRST_COMPILE.silent = True
    try:
        for part in share:
            compile_part(part)
    except CannotKeep as error:
        sys.exit(f"avatarsim: {error}")
    except MemoryError as error:
        sys.exit(f"avatarsim: {described(error)}")


def compile_distances() -> None:
    """Compile the distance of two shapes: as other kernels call it, and as Python calls it for a start that touches."""
    world = build(part_scene("motion")[0])
    signed_distance(world.poses.vertices, world.geometry.shapes, 0, 1, (0.0, 0.0, 0.0), make_scratch())
    question = (world.poses.vertices, world.geometry.shapes, 0, 1, (0.0, 0.0, 0.0), np.inf, make_scratch())
    cast(KernelDispatcher, signed_distance_up_to).called.compile(tuple(numba.typeof(part) for part in question))


def compile_cleaning() -> None:
    """Clean a motion that comes from above and ends in the floor, whose last posture is beyond a limit."""
    scene, _ = part_scene("posture")
    first = scene.first_sample
    positions = np.tile(first.positions, (3, 1, 1)) - np.array([0.0, 0.3, 0.6])[:, None, None] * np.array([0.0, 0.0, 1.0])
    motion = Motion(
        np.arange(3) / 60.0, positions, np.tile(first.rotations, (3, 1, 1)), np.array([[0.0], [0.0], [1.5]])
    )
    avatar = replace(scene.avatars[0], ignore=(("root", "tip"),))
    model = Model(avatar, coordinates_of(avatar), scene.bodies, ())
    clean(motion, model, options=Options(opinion=False))
    # a body far below that is carried, and put on in between
    box = moving("carried", (Piece(Box((0.1, 0.1, 0.1))),), "wood")
    places = np.linspace((0.0, 0.0, -9.0), (0.1, 0.0, -9.0), 3)[:, None]
    poses = Motion(motion.times, places, np.tile((1.0, 0.0, 0.0, 0.0), (3, 1, 1)), np.zeros((3, 0)))
    clean(motion, model, options=Options(opinion=False), carried=(Carried(box, poses),))
    # a stream with limits comes down to the floor, and brakes there
    shield = Shield(model, speed_limits=1.0, acceleration_limits=10.0)
    down = np.linspace(motion.positions[0], motion.positions[2], 40)
    rest = np.repeat(motion.rotations[:1], 40, axis=0)
    for row in shield.coordinates.rows(Motion(np.arange(40) / 60.0, down, rest, np.zeros((40, 1)))):
        shield(row)
    shield.stop()


def compile_goals() -> None:
    """Reach for places with a tip, and drag it."""
    avatar = part_scene("posture")[0].avatars[0]
    Limb(avatar, {2: np.array([9.0, 0.0, 0.0])}).reach(rest((avatar,)))
    alone, goals = BareAvatars((avatar,)), make_goals(1)
    posture = alone.read(rest((avatar,)))
    approach(alone.skeleton, goals, 0.1, 1e-5, 1, 0.1, 1e-4, posture, make_goal_scratch(alone.skeleton, 1))
    alone.poses(alone.clipped(posture))


def compile_harness() -> None:
    """Compile the kernels of the harness in the checkout around this package."""
    if str(ROOT.parent) not in sys.path:
        sys.path.append(str(ROOT.parent))
    import_module("reference.compile_ahead").compile_kernels()


WITHOUT_FRAMES = {"distance": compile_distances, "cleaning": compile_cleaning, "goals": compile_goals, "harness": compile_harness}
"""Parts that run no frames of an engine."""


def stamp_names(cpu: Cpu) -> list[Path]:
    """Return the files, in a folder of kernels, that mark all as compiled for a processor: one per entry of SOURCES."""
    known_as = hashlib.sha256(repr(cpu).encode()).hexdigest()[:20]
    return [kernel_folder(str(source)) / f"everything-compiled-{known_as}" for source in SOURCES]


def is_compiled() -> bool:
    """Return True if everything is compiled for a processor whose code this machine runs."""
    names = [name for cpu in usable() for name in stamp_names(cpu)]
    found = [(base, name) for base in places.current().read for name in names if (base / name).exists()]
    for base, name in found:
        places.current().use((base / name).parent)
    return {name.parent for _, name in found} == {name.parent for name in names}


@contextmanager
def turn(stamp: Path) -> Iterator[None]:
    """Wait until no other process compiles the same thing."""
    make_private(stamp.parent)
    latch = stamp.with_suffix(".compiling")
    with latch.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
        latch.unlink(missing_ok=True)


def compile_everything(stream: TextIO | None = None) -> bool:
    """Compile all kernels that are not compiled yet and print progress, on the standard output by default; return False if a part
    failed, which then compiles when it is first used. Prints nothing where nothing has to be compiled; where nothing can be kept,
    nothing is compiled, and that is printed."""
    if config.DISABLE_JIT or is_stock() or is_compiled():
        return True
    base = places.current().write
    if base is None:
        return True
    stamps, stream = [base / name for name in stamp_names(compiled_for())], stream or sys.stdout
    try:
        with turn(stamps[0]):
            if is_compiled():
                return True
            good = run_shares(SHARES, stream)
            for stamp in stamps if good else ():
                make_private(stamp.parent)
                stamp.touch()
        return good
    except OSError as error:
        print(f"  stopped: {error}", file=stream)
        return False


def compile_into(folder: Path, stream: TextIO | None = None) -> bool:
    """Compile everything into a folder that serves all users as AVATARSIM_CACHE_DIR; return False if a part failed. Raises
    CannotKeep where nothing can be kept."""
    base, made = folder / NAME, not folder.exists()
    places.use_places(Places(base, required=True))
    if not compile_everything(stream):
        return False
    entries = [base, *base.rglob("*")]
    for path in [folder, *entries] if made else entries:
        path.chmod(0o755 if path.is_dir() else 0o644)
    size = sum(path.stat().st_size for path in entries if path.is_file())
    made_for = f"{1e-6 * size:.0f} MB of kernels for the processor {compiled_for().name}"
    print(f"{base}: {made_for}; set {VARIABLE} to the folder above it", file=stream or sys.stdout)
    return True


def run_shares(shares: tuple[tuple[str, ...], ...], stream: TextIO) -> bool:
    """Compile shares in child processes and print progress once a kernel is compiled; return False if one failed."""
    compiled, announced = Compiled(), False
    # A fork has imported everything already, which takes a second; where there are no forks everything is imported anew.
    child = get_context("fork").Process if sys.platform == "linux" else get_context("spawn").Process
    children = [child(target=compile_share, args=(share, places.current().only)) for share in shares]
    for one in children:
        one.start()
    with Progress("compiling", stream) as progress:
        while running := [one.sentinel for one in children if one.is_alive()]:
            if not announced and compiled.entries() > compiled.files:
                count, announced = compiled.total - compiled.done_at_start, True
                cores = min(len(children), os.cpu_count() or 1)
                length = f"about {seconds(count, cores)} s on {cores} core{'s' if cores > 1 else ''}"
                print(f"compiling up to {count} kernels of the engine, once: {length}", file=stream, flush=True)
            if announced and progress.due:
                done = compiled.done()
                progress.step(done / compiled.total, compiled.progress_text(done))
            wait(running, LOOK)
    if (new := compiled.entries() - compiled.files) > 0:
        print(f"  {new} kernels compiled in {compiled.clock() - compiled.begun:.0f} s", file=stream)
    codes = [one.exitcode for one in children]
    for share, code in zip(shares, codes, strict=True):
        if code != 0:
            print(f"  {', '.join(share)}: {ended_by(code or 0)}", file=stream)
    return not any(codes)
