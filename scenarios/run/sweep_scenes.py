"""Scenes of the study of settings, the errors in each, and how often their frames are timed.

The timing pass of a comparison times the scenes of the short form in the same way, so that a setting has one time on a page.
"""

from collections.abc import Mapping

from runfiles.timing_protocol import RANKED_REPEATS, REPEATS
from scenarios.scenario import Scenario

OVERLAP, LIMITS, OFFSET = "residual_overlap_max", "joint_limit_excess_max", "tracker_offset_rms_free"

SWEEP_SCENES: Mapping[str, tuple[str, ...]] = {
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
"""Scenes of the long form -> metrics of error; each at most ten seconds in its quick length."""

ERRORS = (
    OVERLAP, "wrong_side_frames", LIMITS, "reach_cone_excess_max", OFFSET, "restitution_error_max", "bounce_time_error_max",
    "apex_error_max", "course_error_max", "velocity_error_max", "spin_error_max", "stop_distance_error_max",
    "stop_direction_error_max", "drift_max", "energy_drift_max", "energy_gain_max",
)
"""Metrics of error in any other scene, where they are measured."""

SHORT_SWEEP_SCENES: Mapping[str, tuple[str, ...]] = {
    "bounce_ladder": ("apex_error_max", OVERLAP),
    "stop_distance": ("stop_distance_error_max", OVERLAP),
    "slide_to_roll": ("course_error_max", OVERLAP),
    "coupling_sweep": ("course_error_max", OVERLAP),
    "stack_ten": (OVERLAP, "drift_max"),
    "driven_10cm_wall": (OVERLAP, OFFSET),
}
"""Scenes of the short form in addition to everyday ones -> metrics of error; the first is drawn."""
CLOSED_FORM: Mapping[str, tuple[str, ...]] = {"ball_drop": (OVERLAP, "apex_error_max")}
"""Everyday scenes with a closed form; of all others the errors are overlap and offset."""
TWICE = 300
"""Timed frames from which on RANKED_REPEATS are enough. Smaller: a scene of ten boxes has fewer repeats than its 95th percentile
needs to be stable; larger: the short form spends its time on repeats in place of finer steps."""


def short_errors_of(name: str, scenario: Scenario) -> tuple[str, ...]:
    """Return the errors of a scene in the short form; none for a scene that is not in it."""
    if name in SHORT_SWEEP_SCENES:
        return SHORT_SWEEP_SCENES[name]
    return CLOSED_FORM.get(name, (OVERLAP, OFFSET)) if scenario.everyday else ()


def long_errors_of(name: str) -> tuple[str, ...]:
    """Return the errors of a scene in the long form."""
    return SWEEP_SCENES.get(name, ERRORS)


def repeats_of(frames: int) -> int:
    """Return how often so many rendered frames are timed."""
    return RANKED_REPEATS if frames >= TWICE else REPEATS
