"""Disturbances of timing by the machine: clock, processors that may be used, load, time of other work, pace of the core."""

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
LOOP, LOOPS = 3_000, 50
"""Steps of a loop of fixed work, a tenth of a millisecond, and loops by which a process learns its pace. Fewer: disturbances
of a few microseconds count; more: each repeat begins later."""
SLOWED = 1.2
"""Share of the fastest loop above which the core is shared: its other thread slows one to 1.5 to 1.8. Smaller: the loop's own
noise counts; larger: slower clocks do not."""
PATIENCE = 0.3
"""Longest wait [s] for the full pace. Shorter: most disturbances outlast it; longer: timing on a loaded machine takes longer."""


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


def loop_ns() -> int:
    """Return the least time [ns] of three loops of fixed work."""
    least = 1 << 62
    for _ in range(3):
        total, begun = 0, time.perf_counter_ns()
        for k in range(LOOP):
            total += k * k
        least = min(least, time.perf_counter_ns() - begun)
    return least


class Pace:
    """Wait until the core runs at its full pace: neighbours on a shared core slow it for tenths of a second.

    Where the wait is in vain, as on a machine with other work, the next one is half as long.
    """

    def __init__(self, loop: Callable[[], float] = loop_ns, now: Callable[[], float] = time.monotonic) -> None:
        self._loop, self._now = loop, now
        self._fastest, self.patience = min(loop() for _ in range(LOOPS)), PATIENCE

    def wait(self) -> bool:
        """Return True once the core runs at its full pace; False where it does not in time."""
        end = self._now() + self.patience
        while (took := self._loop()) > SLOWED * self._fastest:
            if self._now() > end:
                self.patience *= 0.5
                return False
        self._fastest, self.patience = min(self._fastest, took), min(PATIENCE, 2.0 * self.patience)
        return True
