"""What is each metric called on a page? A short name in words for every metric that `scenarios.metrics` defines."""

WORDS: dict[str, str] = {
    "residual_overlap_max": "deepest overlap shown",
    "residual_overlap_p95": "overlap, 95th percentile of states",
    "residual_overlap_mean": "mean overlap",
    "overlap_frames": "states with overlap",
    "substep_overlap_max": "deepest overlap inside a frame",
    "wrong_side_frames": "frames on the wrong side",
    "restitution_error_max": "error of restitution",
    "apex_error_max": "error of the bounce height",
    "bounce_time_error_max": "error of the time of an impact",
    "zeno_end_error_max": "error of the time at which bouncing ends",
    "course_error_max": "distance from the closed-form course",
    "velocity_error_max": "error of velocity",
    "spin_error_max": "error of angular velocity",
    "drift_max": "drift of what should rest",
    "rest_energy_end": "kinetic energy left at the end of rest",
    "towers_fallen": "towers fallen",
    "ratio_standing_max": "largest ratio of masses that stands",
    "momentum_drift_max": "drift of momentum",
    "angular_momentum_drift_max": "drift of angular momentum",
    "energy_drift_max": "drift of energy",
    "energy_gain_max": "gain of energy in a frame",
    "stop_distance_error_max": "error of the stopping distance",
    "stop_direction_error_max": "error of the stopping direction",
    "flip_time_error_max": "error of the time of a flip",
    "pivot_rate_error_max": "error of a falling rod's angular speed",
    "pivot_missing": "angle that a falling rod fell short of",
    "halted_frames": "frames in which a moving body was halted",
    "status_frames": "frames reported as not ended well",
    "escaped_bodies": "bodies that left their region",
    "travel_missing": "way that a pushed body fell short of",
    "joint_limit_excess_max": "angle beyond joint limits",
    "joint_gap_max": "gap at a joint",
    "reach_cone_excess_max": "angle beyond a reach cone",
    "tracker_offset_max": "farthest from the user",
    "tracker_offset_rms": "offset from the user, all frames",
    "tracker_offset_rms_free": "offset from the user while nothing is in the way",
    "free_frames": "frames in which nothing is in the way",
    "tracker_angle_rms": "joint angle from the user's, all frames",
    "tracker_angle_rms_free": "joint angle from the user's while nothing is in the way",
    "still_frames": "frames that stand still while the user moves",
    "pose_jump_max": "jump of a joint beyond the user's own",
    "root_jump_max": "jump of the root beyond the user's own",
    "chatter_frames": "frames in contact that shake",
    "reversal_p95": "displacement taken back, 95th percentile",
    "contact_gap_p50": "gap to what is touched, median",
    "jerk_ratio": "roughness of motion, shown over the user's",
    "silent_offset_frames": "frames far from a free user without a status",
    "energy_added_max": "kinetic energy that nothing explains",
    "lift_energy_max": "potential energy gained by being moved up",
    "not_finite_frames": "states with a number that is not finite",
    "frame_time_p50": "frame time, median",
    "frame_time_p95": "frame time, 95th percentile",
    "frame_time_p99": "frame time, 99th percentile",
    "frame_time_max": "frame time, slowest frame",
    "frame_time_raw_p50": "frame time with disturbances, median",
    "frame_time_raw_p95": "frame time with disturbances, 95th percentile",
    "frame_time_raw_p99": "frame time with disturbances, 99th percentile",
    "frame_time_raw_max": "frame time with disturbances, slowest frame",
    "frame_time_moving_p50": "frame time while something moves, median",
    "frame_time_resting_p50": "frame time while all rests, median",
    "resting_frames": "timed frames in which all rests",
    "frame_time_python_p50": "frame time as called from Python, median",
    "warmup": "time from start to the first frames",
    "deterministic": "same bits in every repeat",
    "resyncs": "jumps that untied limbs",
    "trapped": "frames in a trap",
    "walled": "frames with a wall between shown and tracked trunk",
    "crossings": "jumps out of a trap or across a wall",
    "leaps": "leaps of the tracker that were followed",
    "run": "the whole run",
}
"""By metric its name on a page; units and definitions stand in `scenarios.metrics`."""
STAGE, WORK = "stage_share_", "_per_frame"


def words(metric: str) -> str:
    """The name of `metric` on a page: its words; for stages and counts of work, and for what a file of another version brings,
    the metric's own words without their underscores."""
    if metric in WORDS:
        return WORDS[metric]
    if metric.startswith(STAGE):
        return f"share of the frame in {metric.removeprefix(STAGE).replace('_', ' ')}"
    if metric.endswith(WORK):
        return f"{metric.removesuffix(WORK).replace('_', ' ')} per frame"
    return metric.replace("_", " ")
