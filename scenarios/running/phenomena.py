"""Test problems of the short sweep: which scenes it takes, by which errors, and how often their frames are timed.

The timing pass of a comparison times these scenes in the same way, so that a setting has one time on a page.
"""

from collections.abc import Mapping

from runfiles.timing_protocol import REPEATS
from scenarios.running.telling import OFFSET, OVERLAP
from scenarios.scenario import Scenario

PHENOMENA: Mapping[str, tuple[str, ...]] = {
    "bounce_ladder": ("apex_error_max", OVERLAP),
    "stop_distance": ("stop_distance_error_max", OVERLAP),
    "slide_to_roll": ("course_error_max", OVERLAP),
    "coupling_sweep": ("course_error_max", OVERLAP),
    "stack_ten": (OVERLAP, "drift_max"),
    "driven_10cm_wall": (OVERLAP, OFFSET),
}
"""Scene -> its errors, the first is drawn: bounce, stop by friction, roll, spring of eq. 6, rest, a driven body at a wall."""
ALSO: Mapping[str, tuple[str, ...]] = {"ball_drop": (OVERLAP, "apex_error_max")}
"""Everyday scenes with a closed form; of all others the penetration counts, and the offset from the tracker stands beside it."""
ONCE = 300
"""Timed frames from which on one repeat is enough for a median: what disturbs a few is lost among the others. The row says how
many it had, and has no 99th percentile."""


def short_errors_of(name: str, scenario: Scenario) -> tuple[str, ...]:
    """The errors of a scene in the short sweep; none for a scene that is not in it. Those of a whole one: `telling.errors_of`."""
    if name in PHENOMENA:
        return PHENOMENA[name]
    return ALSO.get(name, (OVERLAP, OFFSET)) if scenario.everyday else ()


def repeats_of(frames: int) -> int:
    """How often so many rendered frames are timed."""
    return 1 if frames >= ONCE else REPEATS
