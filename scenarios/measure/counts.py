"""Work per frame, as the engine counts it: the columns of the paper's Table 2, and every other count by its own name."""

from scenarios.measure.value import Values
from scenarios.record import Recording

TOTALS = ("waiting", "planning", "following", "out_of_work")
"""Counts that are reported as a sum over the run, under their own name; all others as a mean, `<name>_per_frame`."""


def work(recording: Recording) -> Values:
    """<name>_per_frame: mean over the frames advanced; those of TOTALS: number in all."""
    found: dict[str, float] = {}
    for name, numbers in recording.counts.items():
        done = numbers[1:]
        if name in TOTALS:
            found[name] = float(done.sum())
        elif len(done):
            found[f"{name}_per_frame"] = float(done.mean())
    return found
