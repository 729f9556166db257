"""A campaign of hostile inputs: batches of cases in watched processes, and their findings, once per place."""

import multiprocessing
import signal
import sys
import tempfile
import threading
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import chdir
from dataclasses import dataclass, field
from fnmatch import fnmatch
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, TextIO

from tests.hostile.doors import Door
from tests.hostile.judged import SILENCE, Finding, Judge

BATCH, SLOW_BATCH = 2000, 250
"""Cases of one process: a crash costs the start of another one, about two seconds."""
PATIENCE = 3.0 * SILENCE
"""Longest [s] that a process may stay with one case; its own alarm, which native code does not hear, comes first."""
START = 900.0
"""Longest [s] until a process runs its first case: the engine's kernels may have to be compiled."""
CRASHES = 20
"""Crashes and hangs of one batch after which it is left: a door that crashes every time takes hours otherwise."""
SPAWN = multiprocessing.get_context("spawn")


@cache
def doors() -> dict[str, Door]:
    """Return doors for files, for values and for command lines, by name."""
    # only here: they import all that is tested, which takes a second
    from tests.hostile import constructors, readers, words

    return {door.name: door for door in (*readers.doors(), *constructors.doors(), *words.doors())}


@dataclass(frozen=True)
class Batch:
    """Some cases of a door, given by its name; `own` is a door that is not one of the readers'."""

    door: str
    seed: int
    count: int
    own: Door | None = None


@dataclass
class Report:
    """Number of cases run, per door, and findings: (door, kind, place, words) -> how often, and the first of them."""

    asked: Counter[str] = field(default_factory=Counter)
    found: dict[tuple[str, str, str, str], tuple[int, str]] = field(default_factory=dict)

    def add(self, batch: Batch, case: int, text: str, finding: Finding) -> None:
        """Count a finding, with the command that repeats it."""
        key = batch.door, finding.kind, finding.place, finding.said.partition(":")[0] if finding.kind == "Unsound" else ""
        command = f"python -m tests.hostile --only '{batch.door}' --repeat {batch.seed} {batch.count} {case}"
        count, first = self.found.get(key, (0, f"{finding.said}\n    {text}\n    {command}"))
        self.found[key] = count + 1, first

    def text(self) -> str:
        """Return all of it, most frequent first."""
        lines = [f"{self.asked.total()} cases, {len(self.found)} findings"]
        for (door, kind, place, _), (count, first) in sorted(self.found.items(), key=lambda entry: -entry[1][0]):
            lines.append(f"{count:6} x {door}: {kind} {place}: {first}")
        return "\n".join(lines)


def batches(cases: int, seed: int, only: str) -> Iterator[Batch]:
    """Yield batches of all doors that match, by their weights among these; every door gets one case at least."""
    chosen = [door for door in doors().values() if fnmatch(door.name, only)]
    whole = sum(door.weight for door in chosen)
    for door in chosen:
        left, size = max(1, round(cases * door.weight / whole)), SLOW_BATCH if door.slow else BATCH
        for place, first in enumerate(range(0, left, size)):
            yield Batch(door.name, seed * 10_000 + place, min(left - first, size))


def ask(batch: Batch, first: int, last: int) -> Iterator[tuple[int, str, Finding | None]]:
    """Yield (number, text, finding) of cases from `first` to `last`, first without a finding, as they run in this process."""
    # numpy's warning of overflow on a hostile number is no answer; its result is judged
    warnings.simplefilter("ignore")
    door = batch.own or doors()[batch.door]
    door.warm()
    judge: Judge | None = None
    with tempfile.TemporaryDirectory(prefix="hostile-") as folder:
        for k, case in enumerate(door.cases(batch.seed, batch.count, Path(folder))):
            if first <= k <= last:
                # once the valid files have been made, and their makers are imported
                judge = judge or Judge(door.reserves)
                yield k, case.text[:400], None
                # words may name a file to write, which is then one of this folder
                with chdir(folder):
                    finding = judge.verdict(case)
                if finding is not None:
                    yield k, case.text[:400], finding


def send_findings(batch: Batch, first: int, send: Connection) -> None:
    """Run a batch in a process of its own: every case is sent before it runs, so that a crash is known by its case."""
    for told in ask(batch, first, batch.count):
        send.send(told)
    send.send(None)


def watch(batch: Batch, report: Report, stop: threading.Event) -> None:
    """Run a batch in processes that are watched; after a crash or a hang another one runs the rest."""
    first, crashes = 0, 0
    while first < batch.count and crashes < CRASHES and not stop.is_set():
        receive, send = SPAWN.Pipe(duplex=False)
        process = SPAWN.Process(target=send_findings, args=(batch, first, send))
        process.start()
        send.close()
        now: Any = (-1, "", None)
        try:
            while now is not None and receive.poll(PATIENCE if now[0] >= 0 else START) and not stop.is_set():
                now = receive.recv()
                if now is not None and now[2] is None:
                    report.asked[batch.door] += 1
                elif now is not None:
                    report.add(batch, *now)
            is_hang = now is not None
        except EOFError:
            is_hang = False
        if is_hang:
            process.kill()
        process.join()
        if now is None or stop.is_set():
            return
        code = process.exitcode or 0
        ended = f"crash ({signal.Signals(-code).name})" if code < 0 else f"end of the process with {code}"
        report.add(batch, now[0], now[1], Finding("hang" if is_hang else ended if now[0] >= 0 else "no start", "", ""))
        if now[0] < 0:
            return
        first, crashes = now[0] + 1, crashes + 1


def campaign(wanted: Iterable[Batch], jobs: int, stream: TextIO | None = None) -> Report:
    """Ask batches side by side; whatever goes wrong in them is in the report."""
    report, stop = Report(), threading.Event()
    with ThreadPoolExecutor(max(1, jobs)) as pool:
        running = {pool.submit(watch, batch, report, stop): batch for batch in wanted}
        try:
            for done, future in enumerate(as_completed(running), 1):
                future.result()
                print(f"batch {done}/{len(running)}: {report.asked.total()} cases, {len(report.found)} findings, "
                      f"{running[future].door}", file=stream or sys.stderr, flush=True)
        except KeyboardInterrupt:
            stop.set()
            pool.shutdown(cancel_futures=True)
            raise
    return report
