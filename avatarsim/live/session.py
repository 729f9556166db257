"""A session: one loop process per engine, all following the same targets, and the door's record of each.

Supervisor of worker processes that share nothing (Armstrong 2003): a loop that dies is reported by name and ends only itself,
unless it is the driven one.
"""

import multiprocessing
import shutil
import tempfile
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path
from types import TracebackType
from typing import Self

from avatarsim.clips.atomic_files import write_atomically
from avatarsim.errors import AvatarsimError, InvalidFile, InvalidInput, UnknownName, ended_by
from avatarsim.live.channel import pair
from avatarsim.live.figures import SPAN, Window
from avatarsim.live.loop import run
from avatarsim.live.messages import Answer, Command, Order, Plan, State, Target, Touching
from avatarsim.scene.tracker import TrackerSample, checked

LOADING = 180.0
"""[s] Time limit for loading a loop: a first compile of all kernels takes about a minute."""
ANSWERED = 10.0
"""[s] Time limit for the answer to a command; a switch takes some 20 ms, or much longer if a method has to be compiled first."""
ENDING = 2.0
"""[s] that a loop has to end by itself."""


class LoopRefused(AvatarsimError):
    """A loop whose engine refuses its scene, preset or options."""


class LoopDied(AvatarsimError):
    """A loop process that ended or did not answer; the text names it and gives the cause."""


class Driven:
    """A loop process as seen by its session: newest state, figures, refusals."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self._channel, other = pair()
        self._orders, loop_end = multiprocessing.get_context("spawn").Pipe()
        self._process = multiprocessing.get_context("spawn").Process(
            target=run, args=(plan, other, loop_end), name=f"avatarsim live: {plan.name}", daemon=True
        )
        self._process.start()
        other.close()
        loop_end.close()
        self.window = Window(plan.rate)
        self.state: State | None = None
        self.touching: Touching | None = None

    def is_loaded(self) -> bool:
        """Return True once the loop reports that it has begun. Raises LoopRefused with its reason if it could not, LoopDied if it
        ended."""
        answer = self.answered(0, LOADING)
        if answer.refused:
            raise LoopRefused(f"{self.plan.name} could not begin: {answer.refused}")
        return True

    @property
    def is_alive(self) -> bool:
        """Return True if its process runs."""
        return self._process.is_alive()

    def look(self) -> State | None:
        """Take all states that have arrived and return the newest."""
        for message in self._channel.drain():
            if isinstance(message, Touching):
                self.touching = message
            else:
                self.window.add(message)
                self.state = message
        return self.state

    @property
    def pid(self) -> int:
        """Number of its process."""
        return self._process.pid or 0

    def send(self, target: Target) -> bool:
        """Send a target; False if the loop has not taken the last ones."""
        return self._channel.send(target)

    def order(self, command: Command) -> None:
        """Send a command. Raises LoopDied if the loop cannot receive it."""
        try:
            self._orders.send(command)
        except OSError as error:
            raise self._dead() from error

    def answered(self, number: int, patience: float = ANSWERED) -> Answer:
        """Return the answer to a command. Raises LoopDied if none comes in time."""
        until = time.monotonic() + patience
        while (left := until - time.monotonic()) > 0.0:
            try:
                if self._orders.poll(min(left, 0.1)):
                    answer: Answer = self._orders.recv()
                    if answer.number == number:
                        return answer
                elif not self.is_alive:
                    break
            except (EOFError, OSError):
                break
        raise self._dead()

    def _dead(self) -> LoopDied:
        code = self._process.exitcode
        return LoopDied(f"{self.plan.name} " + ("does not answer" if code is None else ended_by(code)))

    def close(self) -> None:
        """End the process, by force if it does not end by itself."""
        try:
            self._orders.send(Command(Order.STOP))
        except OSError:
            pass
        self._process.join(ENDING)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._orders.close()
        self._channel.close()


class Session:
    """All loops of one live scene. `plans`: the user drives the first loop, the others follow the same targets; `sent` has the
    targets of the last seconds.

    Use it as a context manager, which ends its processes. Raises LoopRefused if a loop cannot begin, LoopDied if it ends."""

    def __init__(self, plans: Sequence[Plan]) -> None:
        if not plans:
            raise InvalidInput("plans of a session", 0, "at least 1")
        names = [plan.name for plan in plans]
        if len(set(names)) < len(names):
            raise InvalidInput("names of the plans of a session", names, "each another")
        self._folder = Path(tempfile.mkdtemp(prefix="avatarsim-live-"))
        self._numbers, self._commands = count(1), count(1)
        self.loops: dict[str, Driven] = {}
        self.sent: deque[Target] = deque(maxlen=round(SPAN * max(plan.rate for plan in plans)))
        try:
            for k, plan in enumerate(plans):
                self.loops[plan.name] = Driven(replace(plan, logs="" if k else str(self._folder)))
            for loop in self.loops.values():
                loop.is_loaded()
        except BaseException:
            self.close()
            raise
        self.first = self.loops[names[0]]
        self.scene = self.first.plan.scene

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def send(self, sample: TrackerSample, stamp: int | None = None) -> None:
        """Send a target to all loops; `stamp` [ns] is monotonic time, now by default.

        Raises InvalidSample for a sample that does not fit the avatars or is not finite."""
        sample = checked(sample, self.scene.avatars)
        target = Target(sample, time.monotonic_ns() if stamp is None else stamp, next(self._numbers))
        self.sent.append(target)
        for loop in self.loops.values():
            loop.send(target)

    def command(self, order: Order, value: object = None) -> dict[str, Answer]:
        """Send a command to all loops and return their answers by name. Raises LoopDied if the first one does not answer."""
        number = next(self._commands)
        for name, loop in list(self.loops.items()):
            try:
                loop.order(Command(order, value, number))
            except LoopDied:
                self._lost(name)
        answers = {}
        for name, loop in list(self.loops.items()):
            try:
                answers[name] = loop.answered(number)
            except LoopDied:
                self._lost(name)
        return answers

    def join(self, loop: Driven) -> None:
        """Add a loaded loop that follows the targets. Raises InvalidInput if its name is already used."""
        if loop.plan.name in self.loops:
            raise InvalidInput("name of a loop that joins a session", loop.plan.name, "one that no other loop has")
        self.loops[loop.plan.name] = loop

    def leave(self, name: str) -> None:
        """End a loop other than the first. Raises InvalidInput for the first, UnknownName for an unknown name."""
        if name not in self.loops:
            raise UnknownName("loop", name, self.loops)
        if self.loops[name] is self.first:
            raise InvalidInput("loop that leaves a session", name, "one that the user does not drive")
        self.loops.pop(name).close()

    def _lost(self, name: str) -> None:
        """Drop a loop that died from the session; without the first loop there is no session."""
        if self.loops[name] is self.first:
            raise self.loops[name]._dead()
        self.loops.pop(name).close()

    def look(self) -> dict[str, State]:
        """Return the newest state of each loop that has shown one. Raises LoopDied if the first loop has ended."""
        states = {}
        for name, loop in list(self.loops.items()):
            state = loop.look()
            if not loop.is_alive:
                self._lost(name)
            elif state is not None:
                states[name] = state
        return states

    @property
    def states(self) -> dict[str, State]:
        """Return the newest state of each loop as found by the last `look`; callable from any thread."""
        return {name: loop.state for name, loop in list(self.loops.items()) if loop.state is not None}

    def save(self, path: Path) -> None:
        """Save the recording since the scene began, as a file for `avatarsim replay`.

        Raises InvalidFile if there is nothing to save or the file cannot be written; an existing file then stays."""
        answer = self.command(Order.SAVE)[self.first.plan.name]
        if answer.refused:
            raise InvalidFile("recording", str(path), answer.refused)
        try:
            write_atomically(path, Path(answer.text).read_bytes())
        except OSError as error:
            raise InvalidFile("recording", str(path), f"a place that takes a file ({error.strerror})") from error

    def close(self) -> None:
        """End all processes and remove their logs."""
        for loop in self.loops.values():
            loop.close()
        shutil.rmtree(self._folder, ignore_errors=True)
