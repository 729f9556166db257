"""Order of losses by what a user sees: what appears on a screen first, then what is measured over a whole motion, then times."""

from collections.abc import Iterable

from runfiles.behind import Behind
from runfiles.ranked import RANKED

SEEN = (
    "not_finite_frames", "wrong_side_frames", "escaped_bodies", "towers_fallen", "residual_overlap_max", "link_jump_max",
    "root_jump_max", "reversal_max", "lift_height_max", "chatter_frames", "pose_jump_max", "tracker_offset_max",
    "silent_offset_frames", "still_frames", "halted_frames", "joint_limit_excess_max", "course_error_max",
)
"""Ranked metrics that a screen shows in single frames; the others follow in the order of the registry."""


def place(metric: str) -> int:
    """Where a metric stands among the losses of a reader: smaller is seen sooner."""
    if metric in SEEN:
        return SEEN.index(metric)
    order = tuple(RANKED)
    return len(SEEN) + (order.index(metric) if metric in order else len(order))


def by_sight(found: Iterable[Behind]) -> list[Behind]:
    """Losses of one scene in that order."""
    return sorted(found, key=lambda one: place(one.row.metric))
