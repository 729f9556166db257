"""What the harness itself costs per query: its clock and its loop, around a call that does nothing."""

import time

import numpy as np

ROUNDS = 2000
"""Frames of nothing; a hundredth of a second in all."""


def loop_cost(pairs: int) -> tuple[float, float]:
    """(clock alone, clock and a loop of `pairs` calls of an empty built-in) [us] per query. Neither is subtracted anywhere."""
    clock, bare, looped = time.perf_counter_ns, [], []
    nothing, calls = int, [((), ())] * pairs
    for _ in range(ROUNDS):
        begun = clock()
        bare.append(clock() - begun)
        begun = clock()
        for _a, _b in calls:
            nothing()
        looped.append(clock() - begun)
    return float(np.median(bare)) / (1e3 * pairs), float(np.median(looped)) / (1e3 * pairs)
