"""Compile the kernels before they are needed: once per version of the sources, in parallel, with progress shown.

Progress and remaining time of a compilation, from the cache folder alone.

Every compiled kernel is a file on disk, and the kernels of the package are known from importing it. Files of an earlier
compilation count as done.
"""

import fcntl
import gc
import hashlib
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from multiprocessing import get_context
from multiprocessing.connection import wait
from pathlib import Path
from typing import TextIO, cast

import numba
import numpy as np

from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Options, clean
from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance, signed_distance_up_to
from avatarsim.console import Progress
from avatarsim.engine import Settings
from avatarsim.files import VARIABLE, make_private
from avatarsim.jit import places
from avatarsim.jit.cache import SUFFIX
from avatarsim.jit.first_compile import FIRST_COMPILE
from avatarsim.jit.kernel import ROOT, config, is_stock, kernel_folder
from avatarsim.jit.linking import KernelDispatcher
from avatarsim.jit.places import NAME, CannotKeep, Places
from avatarsim.jit.processor import Cpu, compiled_for, usable
from avatarsim.many_worlds import advance_many
from avatarsim.model.world import build
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine


def kernels() -> list[KernelDispatcher]:
    """Every kernel that a module of the package holds; nearly all are compiled for one signature, so there are as many files."""
    modules = [module for name, module in sys.modules.items() if name.startswith(f"{ROOT.name}.")]
    held = [one for module in modules for one in vars(module).values() if isinstance(one, KernelDispatcher)]
    return list({id(one): one for one in held}.values())


class Compiled:
    """The kernels of the package, and how many of them are compiled by now."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        found = kernels()
        self.clock = clock
        self.total, self.folders = len(found), {one.folder for one in found}
        self.kept, self.begun = self.done(), clock()

    def done(self) -> int:
        """Kernels on disk, at most as many as there are."""
        bases = set(places.current().read) | {place for place in [places.current().write] if place is not None}
        kept = {(folder, path.name) for base in bases for folder in self.folders for path in (base / folder).glob(f"*{SUFFIX}")}
        return min(len(kept), self.total)

    def left(self, done: int) -> float:
        """[s] until all are done if it goes on as it went; infinite at first."""
        new = done - self.kept
        return (self.total - done) * (self.clock() - self.begun) / new if new else float("inf")

    def told(self, done: int) -> str:
        """So many of so many, and the time that is left; not before a tenth is done, for the first ones say little."""
        told = f"{done} of {self.total} kernels"
        tells = done - self.kept >= self.total // 10 and done < self.total
        return f"{told}, about {self.left(done):.0f} s left" if tells else told


SHARES = (("distance", "posture", "cleaning"), ("motion", "paper", "worlds"))
"""Shares of the compilation, each in a process of its own, its parts one after the other; the shares take equally long.
Distances, which all other parts call, come first in one and a third of the way through the other: a process waits for a kernel
that another one is compiling. Posture and motion together compile all kernels of a scene with both; worlds are what calls these
for many engines at once, and contacts; cleaning proves ways between recorded postures. Memory grows by half a gigabyte per
process."""

PARTS = tuple(part for share in SHARES for part in share)
"""All parts."""

LOOK = 0.5
"""[s] between two looks at how far the processes are; longer tells late, shorter takes time from them."""


def part_scene(part: str) -> tuple[Scene, str]:
    """A small scene that calls every kernel of a part, or of posture and motion together, and the preset to run it with."""
    ball = (Piece(Sphere(0.05)),)
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.1))),), "wood", (0.0, 0.0, -0.05))
    loose = simulated("ball", ball, "wood", solid(ball, 0.2), (0.0, 0.0, 0.2))
    links = (
        Link("root", None, Free(), ball, solid(ball, 1.0)),
        Link("limb", "root", Ball(), ball, solid(ball, 1.0), anchor=(0.0, 0.0, 0.2)),
        Link("tip", "limb", Hinges((Hinge((1.0, 0.0, 0.0), -1.0, 1.0),)), ball, solid(ball, 1.0), anchor=(0.0, 0.0, 0.2)),
    )
    avatars = () if part == "motion" else (Avatar("a", links, chains=("tip",)),)
    start = rest(avatars)
    start.positions[:] = (0.5, 0.5, 0.5)
    bodies = (floor, loose) if part in ("motion", "together", "worlds") else (floor,)
    return Scene(part, bodies, avatars, start=start), "paper" if part == "paper" else "default"


def compile_part(part: str) -> None:
    """Load the part's scene and run two frames of it; numba keeps on disk what it compiles on the way."""
    # The compiler makes and keeps millions of objects: looking through them for rings of garbage costs it a tenth of its time.
    gc.disable()
    if part == "distance":
        compile_distances()
        return
    if part == "cleaning":
        compile_cleaning()
        return
    scene, preset = part_scene(part)
    engine = AvatarsimEngine()
    engine.load(scene, Settings(preset=preset), 1.0 / 60.0)
    first = scene.first_sample
    for k in range(1, 3):
        lower = first.positions - np.array([0.0, 0.0, 0.3 * k])
        sample = TrackerSample(k / 60.0, lower, first.rotations, first.angles)
        if part == "worlds":
            advance_many([engine], [sample], 1.0 / 60.0, threads=1)
            engine.contacts(1.0)
        else:
            engine.advance(sample, 1.0 / 60.0)
    engine.close()


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


def compile_distances() -> None:
    """Compile what finds how far two shapes are apart: as other kernels call it, and as Python does of a start that touches."""
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
    model = Model(replace(scene.avatars[0], ignore=(("root", "tip"),)), None, scene.bodies, ())
    clean(motion, model, options=Options(opinion=False))


def stamp_name(cpu: Cpu) -> Path:
    """The file, within a place of kernels, that says that everything is compiled for these very sources and a processor."""
    known_as = hashlib.sha256(repr(cpu).encode()).hexdigest()[:20]
    return kernel_folder(str(ROOT / "simulator.py")) / f"everything-compiled-{known_as}"


def is_compiled() -> bool:
    """Whether everything is compiled for a processor whose code this machine runs."""
    return any((base / stamp_name(cpu)).exists() for base in places.current().read for cpu in usable())


@contextmanager
def turn(stamp: Path) -> Iterator[None]:
    """Wait until no other process compiles the same thing."""
    make_private(stamp.parent)
    latch = stamp.with_suffix(".compiling")
    with latch.open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        yield
        latch.unlink(missing_ok=True)


def compile_everything(stream: TextIO | None = None) -> bool:
    """Compile what is not compiled yet and say how far it is, on the standard output unless told otherwise; False if a part
    failed, which then compiles when it is first used. Where nothing can be kept nothing is compiled, and that is said."""
    if config.DISABLE_JIT or is_stock() or is_compiled():
        return True
    base = places.current().write
    if base is None:
        return True
    stamp, stream = base / stamp_name(compiled_for()), stream or sys.stdout
    print("compiling the engine's kernels: once, half a minute to two minutes on 2 cores", file=stream, flush=True)
    try:
        with turn(stamp):
            if stamp.exists():
                return True
            good = run_shares(SHARES, stream)
            if good:
                stamp.touch()
        return good
    except OSError as error:
        print(f"  stopped: {error}", file=stream)
        return False


def compile_into(folder: Path, stream: TextIO | None = None) -> bool:
    """Compile everything into a folder that serves all users as AVATARSIM_CACHE_DIR; False if a part failed. Raises CannotKeep
    where nothing can be kept."""
    base, made = folder / NAME, not folder.exists()
    places.use_places(Places(base, required=True))
    if not compile_everything(stream):
        return False
    kept = [base, *base.rglob("*")]
    for path in [folder, *kept] if made else kept:
        path.chmod(0o755 if path.is_dir() else 0o644)
    size = sum(path.stat().st_size for path in kept if path.is_file())
    made_for = f"{1e-6 * size:.0f} MB of kernels for the processor {compiled_for().name}"
    print(f"{base}: {made_for}; set {VARIABLE} to the folder above it", file=stream or sys.stdout)
    return True


def run_shares(shares: tuple[tuple[str, ...], ...], stream: TextIO) -> bool:
    """Compile shares in child processes and say how far they are; False if one of them failed."""
    compiled = Compiled()
    # A fork has imported everything already, which takes a second; where there are no forks everything is imported anew.
    child = get_context("fork").Process if sys.platform == "linux" else get_context("spawn").Process
    children = [child(target=compile_share, args=(share, places.current().only)) for share in shares]
    for one in children:
        one.start()
    with Progress("compiling", stream) as progress:
        while running := [one.sentinel for one in children if one.is_alive()]:
            if progress.due:
                done = compiled.done()
                progress.step(done / compiled.total, compiled.told(done))
            wait(running, LOOK)
    print(f"  {compiled.done()} kernels compiled in {compiled.clock() - compiled.begun:.0f} s", file=stream)
    codes = [one.exitcode for one in children]
    for share, code in zip(shares, codes, strict=True):
        if code != 0:
            print(f"  {', '.join(share)}: failed with code {code}", file=stream)
    return not any(codes)
