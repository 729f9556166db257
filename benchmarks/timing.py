"""The timing loop of the benchmarks: contenders take turns, repeat by repeat."""

import gc
import time
from collections.abc import Callable, Hashable, Mapping
from math import inf
from typing import TypeVar

Name = TypeVar("Name", bound=Hashable)
Figures = TypeVar("Figures")


def take_turns(contenders: Mapping[Name, Callable[[], Figures]], repeats: int, limit: float = inf) -> dict[Name, list[Figures]]:
    """Call every contender `repeats` times and return its figures, one entry per repeat.

    Each repeat begins with another contender, so that no contender always follows the same one. Garbage is not collected
    meanwhile. A contender whose calls took more than `limit` [s] in all gets no further repeat.
    """
    names, spent = list(contenders), dict.fromkeys(contenders, 0.0)
    figures: dict[Name, list[Figures]] = {name: [] for name in names}
    collecting = gc.isenabled()
    gc.disable()
    try:
        for repeat in range(repeats):
            first = repeat % max(1, len(names))
            for name in names[first:] + names[:first]:
                if spent[name] <= limit:
                    begun = time.perf_counter()
                    figures[name].append(contenders[name]())
                    spent[name] += time.perf_counter() - begun
    finally:
        if collecting:
            gc.enable()
    return figures
