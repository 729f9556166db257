"""Random driving of a live page for minutes: late frames, the slowest frame, latency, memory, and overlap by the judge.

    python -m tests.stability.live_driving --seconds 600 --viewers 1
    python -m tests.stability.live_driving --seconds 600 --viewers 3 --deaf 1
    python -m tests.stability.live_driving --seconds 60 --garbage

Drags into table and walls, keys, flicks and resets are drawn from a seed. Viewers are headless browsers; a deaf one opens the
page's socket and never reads. Meanwhile `tests.stability.garbage` sends garbage to ports and page. Exit code 1 where a
bound of `BOUNDS` is missed.
"""

import argparse
import asyncio
import os
import random
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import websockets

from avatarsim.engine import FrameRecord, Settings
from avatarsim.live.drive.driver import Driver
from avatarsim.live.drive.keys import KEYS
from avatarsim.live.messages import Order, Plan
from avatarsim.live.ports.refusals import Refusals
from avatarsim.live.ports.server import Ports
from avatarsim.live.recording import ENGINE, read
from avatarsim.live.replaying import replay
from avatarsim.live.session import Session
from avatarsim.live.stages import stage
from avatarsim.live.view.depth import own_depth
from avatarsim.live.view.page import Page, Shows
from avatarsim.scene.scene import Scene
from reference.judging.judge import Judge
from tests.look.browser import Browser

BOUNDS = {"late_percent": 0.1, "worst_ms": 2.0, "latency_p99_ms": 20.0, "memory_percent": 5.0, "overlap_m": 1e-6}
"""Bounds of a run: late frames and growth of memory in percent, frame and latency in ms, overlap in metres."""
WARM = 20.0
"""[s] after which figures and memory count: viewers load meanwhile."""


class Wild:
    """A user that does something else every so often."""

    def __init__(self, page: Page, seed: int) -> None:
        self._page, self._random, self._next, self._held = page, random.Random(seed), 0.0, list[str]()
        scene = page.session.scene
        starts = np.array([body.position for body in scene.bodies])
        self._low, self._high = starts.min(axis=0) - 0.3, starts.max(axis=0) + 0.3

    def act(self, now: float) -> None:
        """Do the next thing where it is due."""
        if now < self._next:
            return
        self._next = now + self._random.uniform(0.05, 1.2)
        what = self._random.random()
        if what < 0.55:
            name = self._random.choice(self._page.shows.stage.handles)
            self._held.append(name)
            goal = [self._random.uniform(a, b) for a, b in zip(self._low, self._high, strict=True)]
            self._page.post(lambda: self._page.driver.drag(name, goal))
        elif what < 0.7:
            held, self._held = self._held, []
            for name in held:
                self._page.post(partial(self._page.driver.release, name))
        elif what < 0.995:
            key = self._random.choice(KEYS).key
            self._page.post(lambda: self._page.driver.press(key))
        else:
            self._page.post(lambda: self._page.session.command(Order.BACK))


def deaf(address: str, is_over: threading.Event) -> None:
    """Open the page's socket and read nothing."""
    import viser

    async def sit() -> None:
        protocol = websockets.Subprotocol(f"viser-v{viser.__version__}")
        async with websockets.connect(address.replace("http", "ws"), subprotocols=[protocol], max_queue=1):
            while not is_over.is_set():
                await asyncio.sleep(0.2)

    asyncio.run(sit())


def resident(pid: int) -> float:
    """Return the resident memory [MB] of a process."""
    words = Path(f"/proc/{pid}/statm").read_text().split()
    return int(words[1]) * 4096 / 1e6


def judged(path: Path, every: int) -> tuple[float, int, bool]:
    """Deepest overlap [m] of every so many frames of a recording, how many those are, and whether it replays to the bit."""
    found, poses = read(path), list[tuple[np.ndarray, np.ndarray]]()

    def kept(frame: int, record: FrameRecord) -> None:
        if frame % every == 0:
            poses.append((record.shown.positions, record.shown.orientations))

    done = replay(found, kept)
    positions, orientations = (np.array(one) for one in zip(*poses, strict=True))
    return Judge(found.plan.scene).deepest(positions, orientations), len(poses), done.difference is None


class Numbers(NamedTuple):
    """The kept part of a state: to keep all of it would be the memory that is measured."""

    is_late: bool
    engine_ns: int
    cpu_ns: int
    latency: int
    skipped: int


def driven(asked: argparse.Namespace, folder: Path) -> dict[str, float]:
    """Drive for the requested time; return the figures."""
    found, states, memory = stage(asked.scene), dict[int, Numbers](), list[float]()
    with ExitStack() as stack:
        session = stack.enter_context(Session([Plan(ENGINE, found.scene, Settings(time_stages=True), asked.rate)]))
        page = Page(session, Driver(found.scene), Shows(found, {}, own_depth(found.scene), port=0))
        stack.callback(page.close)
        is_over = threading.Event()
        refused = stack.enter_context(beside(page, found.scene, asked)) if asked.garbage else Refusals()
        for _ in range(asked.viewers - asked.deaf):
            stack.enter_context(Browser()).visit(page.address)
        if asked.deaf:
            threading.Thread(target=deaf, args=(page.address, is_over), daemon=True).start()
        wild, begun, told = Wild(page, asked.seed), time.monotonic(), 0.0

        def is_due() -> bool:
            nonlocal told
            now = time.monotonic() - begun
            wild.act(now)
            if now - told >= 5.0:
                told = now
                if now > WARM:
                    for s in session.first.window.states():
                        states[s.frame] = Numbers(*(getattr(s, name) for name in Numbers._fields))
                    memory.append(resident(session.first.pid) + resident(os.getpid()))
                print(f"\r{now:4.0f} s, {session.first.window.figures()}"[:150], end="", file=sys.stderr, flush=True)
            return now > asked.seconds

        page.rounds(is_due)
        is_over.set()
        session.save(folder / "a.live")
        print(f"\nrefused: {refused.counts}", file=sys.stderr)
    return figures(list(states.values()), memory)


def figures(states: list[Numbers], memory: list[float]) -> dict[str, float]:
    """Return late frames, slowest frames, latency and memory."""
    missed = max(s.skipped for s in states) - min(s.skipped for s in states)
    worst, third = max(states, key=lambda s: s.engine_ns), len(memory) // 3
    return {
        "frames": len(states), "late_percent": 100.0 * (sum(s.is_late for s in states) + missed) / len(states),
        "skipped": missed, "worst_ms": 1e-6 * worst.engine_ns, "its_cpu_ms": 1e-6 * worst.cpu_ns,
        "over_2_ms": sum(s.engine_ns > 2e6 for s in states),
        "p99_ms": 1e-6 * float(np.percentile([s.engine_ns for s in states], 99)),
        "latency_p99_ms": 1e-6 * float(np.percentile([s.latency for s in states if s.latency >= 0] or [0], 99)),
        "memory_mb": memory[-1],
        "memory_percent": 100.0 * (float(np.median(memory[-third:])) / float(np.median(memory[:third])) - 1.0),
    }


@contextmanager
def beside(page: Page, scene: Scene, asked: argparse.Namespace) -> Iterator[Refusals]:
    """Run ports, and a process that sends garbage to them and to the page; yield the refusals of the ports."""
    with Ports(scene, page.track) as page.ports:
        udp, ws = (page.ports.addresses[kind][1] for kind in ("udp", "websocket"))
        where = ["--udp", str(udp), "--ws", str(ws), "--page", str(page.server.get_port())]
        how_long = ["--seconds", str(asked.seconds), "--seed", str(asked.seed)]
        with subprocess.Popen([sys.executable, "-m", "tests.stability.garbage", *where, *how_long]):
            yield page.ports.refusals
        print(f"refused at the page: {page.server.refusals.counts}", file=sys.stderr)


def main() -> int:
    """Return the exit code."""
    top = argparse.ArgumentParser(description="Random driving of a live page.")
    top.add_argument("--seconds", type=float, default=600.0)
    top.add_argument("--scene", default="hand", choices=("hand", "toys", "gallery"))
    top.add_argument("--rate", type=float, default=60.0)
    top.add_argument("--viewers", type=int, default=1)
    top.add_argument("--deaf", type=int, default=0, choices=(0, 1), help="of the viewers, how many never read")
    top.add_argument("--garbage", action="store_true", help="send garbage to ports and page meanwhile")
    top.add_argument("--seed", type=int, default=1)
    top.add_argument("--judge-every", type=int, default=10)
    asked = top.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        figures = driven(asked, Path(folder))
        depth, count, is_same = judged(Path(folder) / "a.live", asked.judge_every)
    figures |= {"overlap_m": depth, "judged": count, "replays": float(is_same)}
    for name, value in figures.items():
        bound = BOUNDS.get(name)
        kept = "" if bound is None else f"   at most {bound:g}{'' if value <= bound else '  MISSED'}"
        print(f"{name:16} {value:10.4g}{kept}")
    return int(not is_same or any(not figures[name] <= bound for name, bound in BOUNDS.items()))


if __name__ == "__main__":
    sys.exit(main())
