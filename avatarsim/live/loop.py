"""Fixed-timestep loop of one engine, in a process of its own (Fiedler 2004; periodic tasks: Liu and Layland 1973).

Frame k is due at a fixed instant of the monotonic clock. It takes the newest target or, if none has come since the last frame,
repeats the last one. Late frames are counted and never made up for: missed slots are skipped, so that a slow frame is followed by
no burst of quick ones. Python's collector runs only if a frame has time left.
"""

import gc
import os
import time
from collections.abc import Collection
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from pkgutil import resolve_name

import numpy as np

from avatarsim.engine import Engine, FrameRecord
from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName, described
from avatarsim.live.channel import Channel
from avatarsim.live.messages import Answer, Array, Command, Order, Plan, State, Target, Touching
from avatarsim.live.orders import World
from avatarsim.live.recording import Recorder
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation

COLLECTED = 64
"""Frames between two runs of Python's collector over the youngest objects: at 60 Hz one a second, of some 20 us."""
PRIORITY = 1
"""Lowest real-time priority: enough to run before all processes without one."""
TOUCHED = 2
"""Frames between two queries of contacts: 30 a second at 60 Hz, as often as a page draws."""


def run(plan: Plan, channel: Channel, orders: Connection) -> None:
    """Run the loop process: load the scene, report the result, and loop until STOP or until the session's end of a pipe closes.

    The first message on `orders` is an `Answer` whose `refused` gives the reason why loading failed; empty on success."""
    try:
        world = World(plan, engine_of(plan.engine))
    except (AvatarsimError, MemoryError) as error:
        orders.send(Answer(0, Order.RESET, 0, str(error) if isinstance(error, AvatarsimError) else described(error)))
        return
    if plan.logs:
        # the driven loop; another one that cannot keep its rate would take the processor from everything else
        go_first()
    orders.send(Answer(0, Order.RESET, 0))
    gc.collect()
    gc.freeze()
    gc.disable()
    # the loop ends when the session's process is gone, or on a break that a terminal sends to all of its processes
    with suppress(EOFError, BrokenPipeError, KeyboardInterrupt):
        Loop(world, channel, orders).run()


def go_first() -> None:
    """Give this process real-time priority, where the system supports and allows it: a page that is drawn on the same processors
    waits rather than a frame. A loop sleeps most of the time."""
    with suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(PRIORITY))


def engine_of(words: str) -> type[Engine]:
    """Return the class named by "module:class". Raises UnknownName if it cannot be found, InvalidInput if it is no class."""
    try:
        found = resolve_name(words)
    except (ImportError, AttributeError, ValueError) as error:
        raise UnknownName("engine of a loop", words, ["avatarsim.simulator:AvatarsimEngine"]) from error
    if not isinstance(found, type):
        raise InvalidInput("engine of a loop", words, "the class of an engine")
    return found


class Loop:
    """State of a loop: the next frame, the newest target, and the log."""

    def __init__(self, world: World, channel: Channel, orders: Connection) -> None:
        self.world, self._channel, self._orders = world, channel, orders
        self._period = round(1e9 * world.dt)
        self._sample: TrackerSample = world.scene.first_sample
        self._target, self._stamp, self._used = 0, 0, True
        self._frame = self._skipped = self._steps = 0
        self._is_paused = self._is_over = False
        self._log: Recorder | None = None
        self._links = frozenset(name for one in world.scene.avatars[:1] for name in one.link_names)
        self._logs = self._on_cpu = 0
        self._turns: Array = self.world.shown.shown.orientations
        self._begin_log()

    def run(self) -> None:
        """Run frames at their due instants until a STOP command."""
        due = time.monotonic_ns()
        self._publish(self.world.shown, 0, due)
        while not self._is_over:
            due += self._period
            now = time.monotonic_ns()
            if now > due:
                missed = (now - due) // self._period
                self._skipped += 0 if self._is_paused else missed
                due += missed * self._period
            if now < due:
                time.sleep(1e-9 * (due - now))
            self._obey()
            self._listen()
            if not self._is_paused or self._steps:
                self._steps = max(0, self._steps - 1)
                self._one(due)
        self._close()

    def _one(self, due: int) -> None:
        """Run one frame: advance, publish, log, and collect garbage if there is time."""
        begun, on_cpu = time.monotonic_ns(), time.thread_time_ns()
        record = self.world.advance(self._sample)
        cost, self._on_cpu = time.monotonic_ns() - begun, time.thread_time_ns() - on_cpu
        self._frame += 1
        state_hash = self._publish(record, cost, due)
        if self._log is not None:
            self._log.frame(self._sample, state_hash)
        if self._frame % TOUCHED == 0 and time.monotonic_ns() < due + self._period // 2:
            self._touch()
        if self._frame % COLLECTED == 0 and time.monotonic_ns() < due + self._period // 2:
            gc.collect(0 if self._frame % COLLECTED**2 else 1)

    def _publish(self, record: FrameRecord, cost: int, due: int) -> str:
        """Send the state of a record and return its hash; the latency counts until now."""
        shown, now = record.shown, time.monotonic_ns()
        latency = -1 if self._used else now - self._stamp
        self._used = True
        state_hash = record.state_hash()
        if self._turns.shape == shown.orientations.shape:
            self._turns = rotation.continuous(np.stack([self._turns, shown.orientations]))[1]
        else:
            self._turns = shown.orientations
        self._channel.send(State(
            self._frame, shown.time, shown.positions, self._turns, record.angles, self._target, latency, cost,
            now > due + self._period and not self._is_paused, self._skipped, due + self._period,
            dict(record.statuses), dict(record.counts), dict(record.stage_ns), state_hash, self._is_paused,
            self._log is not None and self._log.is_open, self._on_cpu,
        ))
        return state_hash

    def _touch(self) -> None:
        """Send the contacts, if the engine is AvatarsimEngine, which reports them."""
        if isinstance(self.world.engine, AvatarsimEngine):
            self._channel.send(Touching(self._frame, rows(self.world.engine, self._links)))

    def _listen(self) -> None:
        """Take the newest target; one that does not fit the avatars is ignored, since the session checks all targets before."""
        target: Target | None = self._channel.newest()
        if target is not None:
            with suppress(AvatarsimError):
                self._sample = checked(target.sample, self.world.scene.avatars)
                self._target, self._stamp, self._used = target.number, target.stamp, False

    def _obey(self) -> None:
        """Execute all pending commands and answer each."""
        while self._orders.poll():
            command: Command = self._orders.recv()
            self._orders.send(Answer(command.number, command.order, self._frame, *self._done(command)))

    def _done(self, command: Command) -> tuple[str, str]:
        """Execute a command. Return the reason of a refusal, or "", and the text that the command requested, or ""."""
        order = command.order
        if order is Order.STOP:
            self._is_over = True
        elif order in (Order.PAUSE, Order.GO_ON):
            self._is_paused, self._steps = order is Order.PAUSE, 0
        elif order is Order.STEP:
            self._is_paused, self._steps = True, self._steps + 1
        elif order is Order.SAVE:
            return self._saved()
        else:
            refused = self._applied(command)
            return refused, self.world.report
        return "", ""

    def _applied(self, command: Command) -> str:
        """Apply a command that changes the shown state. Return the reason of a refusal, or ""."""
        refused = self.world.apply(command)
        if refused:
            return refused
        if command.order is Order.RESET:
            self._begin_log()
        elif self._log is not None:
            self._log.command(command)
        gc.collect()
        gc.freeze()
        self._publish(self.world.shown, 0, time.monotonic_ns())
        return ""

    def _begin_log(self) -> None:
        """Begin a log of the world, which has just begun; no log without a folder, or if no file can be created."""
        self._close()
        if not self.world.plan.logs:
            return
        self._logs += 1
        path = Path(self.world.plan.logs) / f"{self._logs}.live"
        with suppress(OSError):
            self._log = Recorder(path, self.world.begun, self.world.shown.state_hash())
            if self.world.pinches:
                self._log.command(Command(Order.PINCH, True))

    def _saved(self) -> tuple[str, str]:
        """Return an error, or "", and the path of the log, after flushing it to the system."""
        if self._log is None:
            return "there is no log of what was driven: its folder takes no files", ""
        self._log.flush()
        return "", str(self._log.path)

    def _close(self) -> None:
        """Close the log, if there is one."""
        if self._log is not None:
            self._log.close()
        self._log = None


def rows(engine: AvatarsimEngine, links: Collection[str]) -> Array:
    """Return (k, 6) points [m] and normals of the contacts of the shown state in which one of `links` takes part."""
    found = [(*one.point, *one.normal) for one in engine.contacts(of=links)]
    return np.array(found, dtype=np.float64).reshape(-1, 6)
