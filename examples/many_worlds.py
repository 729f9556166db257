"""Many independent worlds, a frame of all in one call: how many frames of avatars a second, on one core and on several.

Shows: `advance_many`, and how to time it. Each world is the humanoid of eleven links that walks into a wall, at its own place in
the clip; or, with --hands, the rigid hand that pushes a ball over a table.
Run: python examples/many_worlds.py [--worlds N] [--frames N] [--threads N] [--hands]
"""

import argparse
import os
import time
from collections.abc import Callable, Sequence

from humanoid_on_a_clip import clip, humanoid, room
from rigid_hand import tracked, world

import avatarsim as av

DT = 1.0 / 60.0
"""[s] time of a frame."""
Motion = list[list[av.TrackerSample]]
Way = Callable[[Sequence[av.AvatarsimEngine], Sequence[av.TrackerSample]], object]


def scenes(worlds: int, frames: int, hands: bool) -> tuple[list[av.Scene], Motion]:
    """Return a scene for each world, and for each frame the samples of all worlds; worlds are up to 45 frames ahead."""
    avatar = humanoid()
    ahead = [0 if hands else 5 * k % 50 for k in range(worlds)]
    known = [tracked(frame) if hands else clip(avatar, frame) for frame in range(frames + 46)]
    rooms = [world() if hands else room(avatar, known[first]) for first in ahead]
    return rooms, [[known[first + frame] for first in ahead] for frame in range(1, frames + 1)]


def one_by_one(engines: Sequence[av.AvatarsimEngine], samples: Sequence[av.TrackerSample]) -> list[av.FrameRecord]:
    """Return a frame of each world, as one writes it by hand."""
    return [engine.advance(sample, DT) for engine, sample in zip(engines, samples, strict=True)]


def together(threads: int) -> Way:
    """Return a frame of all worlds in one call."""
    return lambda engines, samples: av.advance_many(engines, samples, DT, threads)


def rate(engines: Sequence[av.AvatarsimEngine], motion: Motion, way: Way) -> float:
    """Return frames of avatars a second, Python included: the best of three runs, each from the start."""
    best = 0.0
    for _ in range(3):
        for engine in engines:
            engine.reset()
        begun = time.perf_counter()
        for samples in motion:
            way(engines, samples)
        best = max(best, len(engines) * len(motion) / (time.perf_counter() - begun))
    return best


def main(frames: int = 120, worlds: int = 128, threads: int | None = None, hands: bool = False) -> dict[str, float]:
    """Time the three ways, and print them; returns frames of avatars a second by way."""
    many = threads or os.cpu_count() or 1
    described, motion = scenes(worlds, frames, hands)
    engines = [av.AvatarsimEngine() for _ in described]
    for engine, scene in zip(engines, described, strict=True):
        # a body waits behind its obstacle: to search for a way around takes ten times as long
        engine.load(scene, av.Settings(options={"around": 0}), DT)
    ways = {"one by one": one_by_one, "together, 1 thread": together(1), f"together, {many} threads": together(many)}
    rates = {name: rate(engines, motion, way) for name, way in ways.items()}
    print(f"{worlds} worlds of {'a rigid hand and a ball' if hands else 'a humanoid at a wall'}, {frames} frames each")
    for name, value in rates.items():
        print(f"{name:>22}: {value:9,.0f} frames of avatars a second, {value / rates['together, 1 thread']:.2f} x one thread")
    return rates


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=str(__doc__), formatter_class=argparse.RawDescriptionHelpFormatter)
    for option, default in (("--frames", 120), ("--worlds", 128), ("--threads", None)):
        parser.add_argument(option, type=int, default=default, metavar="N")
    parser.add_argument("--hands", action="store_true")
    main(**vars(parser.parse_args()))
