"""The scenes that are swept unless others are named, and the figures that count as error in each."""

from collections.abc import Mapping

from runfiles.naming import BASELINE
from scenarios import catalog
from scenarios.running.offered import filtered
from scenarios.scenario import Scenario

OVERLAP, LIMITS, OFFSET = "residual_overlap_max", "joint_limit_excess_max", "tracker_offset_rms_free"

TELLING: Mapping[str, tuple[str, ...]] = {
    "mocap_punch_wall": (OVERLAP, LIMITS, OFFSET),
    "hand_grasp": (OVERLAP, LIMITS, OFFSET),
    "limit_torture_hinges": (LIMITS,),
    "hand_in_corner_rigid": (OVERLAP, OFFSET),
    "thin_wall_hand": (OVERLAP, "wrong_side_frames"),
    "stack_ten": (OVERLAP, "drift_max"),
    "bounce_ladder": ("restitution_error_max", "apex_error_max", OVERLAP),
    "oblique_bounce": ("velocity_error_max", "spin_error_max"),
    "stop_distance": ("stop_distance_error_max", "stop_direction_error_max", OVERLAP),
}
"""Scene -> metrics: recorded motion against a wall, an articulated hand with loose things, limits alone, the paper's rigid hand,
a thin wall, rest, bounce, bounce with friction, friction. Each at most ten seconds in its quick length."""

ERRORS = (
    OVERLAP, "wrong_side_frames", LIMITS, "reach_cone_excess_max", OFFSET, "restitution_error_max", "bounce_time_error_max",
    "apex_error_max", "course_error_max", "velocity_error_max", "spin_error_max", "stop_distance_error_max",
    "stop_direction_error_max", "drift_max", "energy_drift_max", "energy_gain_max",
)
"""What counts as error in a scene that is not listed above, if it is measured there."""


def swept(pattern: str | None, full: bool) -> dict[str, Scenario]:
    """Scenes by name: the telling ones, all with `full`, or those that one of the comma-separated patterns lets through."""
    everything = catalog.scenarios()
    if pattern is not None:
        return filtered(everything, pattern)
    return everything if full else {name: everything[name] for name in TELLING}


def errors_of(name: str) -> tuple[str, ...]:
    """The metrics that are this scene's errors in a whole sweep; in the short one: `phenomena.short_errors_of`."""
    return TELLING.get(name, ERRORS)


def swept_engines(known: Mapping[str, str]) -> tuple[str, ...]:
    """All engines but the raw tracker, which has no settings."""
    return tuple(name for name in known if name != BASELINE)
