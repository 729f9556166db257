"""Disturbances of timing by the machine: clock, processors that may be used, load, and time of other work."""

import math
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

STAT = Path("/proc/stat")
"""Linux: time counts of all processors, in ticks. Guests, from FIRST_GUEST on, are counted among the others too."""
CPUINFO, FASTEST = Path("/proc/cpuinfo"), Path("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq")
"""Linux: the clock now [MHz], and the highest [kHz]."""
IDLE, WAITING, FIRST_GUEST = 3, 4, 8
"""Indices among the counts of STAT."""


def usable_cpus() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def load_average() -> list[float] | None:
    """Return the mean number of running processes over 1, 5 and 15 minutes; None where the system does not know."""
    with suppress(AttributeError, OSError):
        return [round(mean, 2) for mean in os.getloadavg()]
    return None


def clock(cpuinfo: Path = CPUINFO, fastest: Path = FASTEST) -> dict[str, int | None]:
    """Return the clock of the fastest processor now, and the highest possible [MHz]; None where the system does not know."""
    rates: dict[str, int | None] = {"mhz": None, "mhz_max": None}
    with suppress(OSError, ValueError, IndexError):
        lines = cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines()
        clocks = [round(float(line.split(":", 1)[1])) for line in lines if line.lower().startswith("cpu mhz")]
        rates["mhz"] = max(clocks, default=None)
    with suppress(OSError, ValueError):
        rates["mhz_max"] = round(int(fastest.read_text(encoding="utf-8")) / 1e3)
    return rates


def reading_ns(readings: int = 2001) -> int:
    """Return the median time [ns] between two readings of the clock: so much of every time is the clock's own."""
    intervals = []
    for _ in range(readings):
        begun = time.perf_counter_ns()
        intervals.append(time.perf_counter_ns() - begun)
    return sorted(intervals)[readings // 2]


def busy_seconds(stat: Path = STAT) -> float:
    """Return the busy time [s] of all processors since the system began, that of a host included; NaN where it is unknown."""
    with suppress(OSError, ValueError, IndexError, AttributeError):
        counts = [int(word) for word in stat.read_text(encoding="utf-8").split("\n", 1)[0].split()[1:]]
        return (sum(counts[:FIRST_GUEST]) - counts[IDLE] - counts[WAITING]) / os.sysconf("SC_CLK_TCK")
    return math.nan


class Meter:
    """Measure how many processors other work keeps busy while one thread is timed; `busy` and `now` are clocks [s]."""

    def __init__(self, busy: Callable[[], float] = busy_seconds, now: Callable[[], float] = time.monotonic) -> None:
        self._busy, self._now = busy, now
        self.seconds, self._all = 0.0, 0.0

    @contextmanager
    def running(self) -> Iterator[None]:
        """Measure while one thread works."""
        before, begun = self._busy(), self._now()
        try:
            yield
        finally:
            self.seconds += self._now() - begun
            self._all += self._busy() - before

    @property
    def others(self) -> float | None:
        """Mean number of processors that other work kept busy; None where it is unknown."""
        mean = self._all / self.seconds - 1.0 if self.seconds > 0.0 else math.nan
        return None if math.isnan(mean) else max(0.0, mean)
