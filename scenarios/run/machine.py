"""Disturbances of timing by the machine: clock, processors that may be used, load, and time that other work took."""

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

STAT = Path("/proc/stat")
"""Where Linux counts what all processors together did."""
CPUINFO = Path("/proc/cpuinfo")
FASTEST = Path("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq")
"""Where Linux tells the highest clock [kHz], if the processor or what stands in for it lets it."""
IDLE, WAITING, FIRST_GUEST = 3, 4, 8
"""Places of idle time and of waiting for disks among the counts; from the last on they count again what others have counted."""


def usable_cpus() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def load_average() -> list[float] | None:
    """Processes that ran or waited to run, on the mean of the last 1, 5 and 15 minutes; None where the system does not tell."""
    try:
        return [round(mean, 2) for mean in os.getloadavg()]
    except (AttributeError, OSError):
        return None


def clock(cpuinfo: Path = CPUINFO, fastest: Path = FASTEST) -> dict[str, int | None]:
    """Clock of the fastest processor at this moment, and the highest it can have [MHz]; None where the system does not tell."""
    return {"mhz": _mhz_now(cpuinfo), "mhz_max": _mhz_most(fastest)}


def reading_ns(readings: int = 2001, now: Callable[[], int] = time.perf_counter_ns) -> int:
    """What a time that is read before and after nothing comes to [ns], the median: so much of every stretch that is timed is the
    clock's own."""
    found = []
    for _ in range(readings):
        begun = now()
        found.append(now() - begun)
    return sorted(found)[readings // 2]


def _mhz_now(cpuinfo: Path) -> int | None:
    try:
        lines = cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines()
        return max((round(float(line.split(":", 1)[1])) for line in lines if line.lower().startswith("cpu mhz")), default=None)
    except (OSError, ValueError, IndexError):
        return None


def _mhz_most(fastest: Path) -> int | None:
    try:
        return round(int(fastest.read_text(encoding="utf-8")) / 1e3)
    except (OSError, ValueError):
        return None


def busy_seconds(stat: Path = STAT) -> float | None:
    """Time [s] that all processors together have been busy since the system began, what a host took included; None where the
    system does not tell."""
    try:
        counts = [int(word) for word in stat.read_text(encoding="utf-8").split("\n", 1)[0].split()[1:]]
        return (sum(counts[:FIRST_GUEST]) - counts[IDLE] - counts[WAITING]) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError, AttributeError):
        return None


class Meter:
    """How many processors other work keeps busy while something on one thread is timed.

    `busy` tells the busy time [s] of all processors, `now` the time [s]."""

    def __init__(self, busy: Callable[[], float | None] = busy_seconds, now: Callable[[], float] = time.monotonic) -> None:
        self._busy, self._now = busy, now
        self.seconds, self._all, self._known = 0.0, 0.0, True

    @contextmanager
    def running(self) -> Iterator[None]:
        """The time in which one thread is at work that is meant to be."""
        before, begun = self._busy(), self._now()
        try:
            yield
        finally:
            spent, after = self._now() - begun, self._busy()
            self.seconds += spent
            if before is None or after is None:
                self._known = False
            else:
                self._all += after - before

    @property
    def others(self) -> float | None:
        """Processors that other work kept busy, on the mean; None where nothing is known."""
        if not self._known or not self.seconds > 0.0:
            return None
        return max(0.0, self._all / self.seconds - 1.0)
