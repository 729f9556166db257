"""A campaign of hostile inputs: batches of cases in watched processes, and what was found, once per place."""

import json
import shlex
import signal
import subprocess
import sys
import time
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import TextIO

from tests.hostile.every import doors
from tests.hostile.judged import ROOT, SILENCE

BATCH, SLOW_BATCH = 2000, 250
"""Cases of one process: a crash costs the start of another one, about two seconds."""
PATIENCE = 3.0 * SILENCE
"""Longest [s] that a process may stay with one case; its own alarm, which native code does not hear, comes first."""
START = 900.0
"""Longest [s] until a process asks its first case: the engine's kernels may have to be compiled."""
CRASHES = 20
"""Crashes and hangs of one batch after which it is left: what crashes every time takes hours otherwise."""


@dataclass(frozen=True)
class Batch:
    """Some cases of a door; `first` is where it begins, after a case that ended its process."""

    door: str
    seed: int
    count: int
    first: int = 0
    crashes: int = 0

    def command(self, *options: str) -> list[str]:
        """The command that asks it."""
        return [sys.executable, "-m", "tests.hostile.batch", self.door, str(self.seed), str(self.count), *options]


@dataclass
class Report:
    """How many cases were asked, per door, and what was found: (door, kind, place, words) -> how often, and the first of them."""

    asked: dict[str, int] = field(default_factory=dict)
    found: dict[tuple[str, str, str, str], tuple[int, str]] = field(default_factory=dict)

    def add(self, batch: Batch, told: dict[str, object]) -> None:
        """Count a finding."""
        said = str(told["said"])
        kind = str(told["kind"])
        key = batch.door, kind, str(told["place"]), said.partition(":")[0] if kind == "Unsound" else ""
        case = str(told["case"])
        command = shlex.join(["python", *batch.command("--first", case, "--last", case)[1:]])
        count, first = self.found.get(key, (0, f"{said}\n    {told['text']}\n    {command}"))
        self.found[key] = count + 1, first

    def text(self) -> str:
        """All of it, most frequent first."""
        lines = [f"{sum(self.asked.values())} cases, {len(self.found)} findings"]
        for (door, kind, place, _), (count, first) in sorted(self.found.items(), key=lambda entry: -entry[1][0]):
            lines.append(f"{count:6} x {door}: {kind} {place}: {first}")
        return "\n".join(lines)


def campaign(wanted: Iterable[Batch], jobs: int, folder: Path, stream: TextIO | None = None) -> Report:
    """Ask batches side by side; whatever goes wrong in them is in the report."""
    report, waiting = Report(), deque(wanted)
    total, running = len(waiting), dict[Batch, Watched]()
    done = 0
    try:
        while waiting or running:
            while waiting and len(running) < max(1, jobs):
                batch = waiting.popleft()
                running[batch] = Watched(batch, folder / f"{batch.seed}-{done}-{len(waiting)}-{batch.first}")
            time.sleep(0.02)
            for batch, watched in list(running.items()):
                if not watched.ended():
                    continue
                del running[batch]
                rest = watched.into(report)
                if rest is None:
                    done += 1
                    if stream:
                        asked, found = sum(report.asked.values()), len(report.found)
                        print(f"batch {done}/{total}: {asked} cases, {found} findings, {batch.door}", file=stream, flush=True)
                else:
                    waiting.appendleft(rest)
    finally:
        for watched in running.values():
            watched.process.kill()
            watched.process.wait()
    return report


def batches(cases: int, seed: int, only: str) -> Iterator[Batch]:
    """Batches of all doors that match, by their weights among these; every door gets one case at least."""
    chosen = [door for door in doors().values() if fnmatch(door.name, only)]
    whole = sum(door.weight for door in chosen)
    for door in chosen:
        left, size, place = max(1, round(cases * door.weight / whole)), SLOW_BATCH if door.slow else BATCH, 0
        while left > 0:
            yield Batch(door.name, seed * 10_000 + place, min(left, size))
            left, place = left - size, place + 1


class Watched:
    """A process that asks a batch."""

    def __init__(self, batch: Batch, out: Path) -> None:
        self.batch, self.out, self.killed = batch, out, False
        self.errors = out.with_suffix(".stderr").open("wb")
        command = batch.command("--first", str(batch.first), "--out", str(out))
        nothing = subprocess.DEVNULL
        self.process = subprocess.Popen(command, cwd=ROOT, stdin=nothing, stdout=nothing, stderr=self.errors)
        self.seen, self.since = "", time.monotonic()

    def ended(self) -> bool:
        """Whether the process is over; one that stays with one case for too long is ended."""
        if self.process.poll() is not None:
            return True
        now = self.now()
        if now != self.seen:
            self.seen, self.since = now, time.monotonic()
        elif time.monotonic() - self.since > (PATIENCE if now else START):
            self.killed = True
            self.process.kill()
            self.process.wait()
            return True
        return False

    def now(self) -> str:
        """Number and text of the case that is being asked, empty before the first."""
        path = Path(f"{self.out}.now")
        return path.read_bytes().decode("utf-8", "replace").strip() if path.exists() else ""

    def into(self, report: Report) -> Batch | None:
        """Add what was found to the report; what is left of the batch, if its process ended within a case."""
        self.errors.close()
        lines = self.out.read_text(encoding="utf-8").splitlines() if self.out.exists() else []
        told = [json.loads(line) for line in lines]
        for entry in told:
            if "asked" not in entry:
                report.add(self.batch, entry)
        door = self.batch.door
        if told and "asked" in told[-1]:
            report.asked[door] = report.asked.get(door, 0) + told[-1]["asked"]
            return None
        number, _, text = self.now().partition(" ")
        last = self.errors_said()
        if not number:
            report.add(self.batch, {"kind": "no start", "place": "", "said": last, "case": 0, "text": ""})
            return None
        code = self.process.returncode
        ended = f"crash ({signal.Signals(-code).name})" if code < 0 else f"end of the process with {code}"
        kind = "hang" if self.killed else ended
        report.add(self.batch, {"kind": kind, "place": "", "said": last, "case": int(number), "text": text})
        report.asked[door] = report.asked.get(door, 0) + int(number) + 1 - self.batch.first
        rest = replace(self.batch, first=int(number) + 1, crashes=self.batch.crashes + 1)
        return rest if rest.first < rest.count and rest.crashes < CRASHES else None

    def errors_said(self) -> str:
        """The last words on the error stream."""
        said = Path(self.errors.name).read_bytes().decode("utf-8", "replace").strip()
        return said.splitlines()[-1][:200] if said else "nothing was said"
