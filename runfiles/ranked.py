"""Which metrics rank engines: the difference that counts as equal for each, or the reason why a metric ranks none.

Smaller is better in every metric that ranks. Page and terminal read this one registry, and a test holds that it has every metric.
"""

from dataclasses import dataclass

from avatarsim.errors import UnknownName
from runfiles.metrics import FAMILIES, METRICS


@dataclass(frozen=True)
class Ranked:
    """`same`: values that differ by no more, in the metric's own unit, count as equal; 0 in a list of losses stands at it too.
    `stays_inside`: an engine that left the allowed side of a scene cannot be best in it. `may_lack`: too few timed frames give
    no value, which says nothing about the engine: a row without one is not ranked; any other missing figure is the worst.
    `share`: values that differ by no more than this share of the smaller count as equal too. `is_truth_error`: a distance from a
    closed form, so that the verdict's column of those takes it."""

    same: float
    stays_inside: bool = False
    may_lack: bool = False
    share: float = 0.0
    is_truth_error: bool = False

    def less(self, one: float, other: float) -> bool:
        """Whether `one` is better than `other`, and not level with it."""
        return one < other - self.same and one * (1.0 + self.share) < other


CLOSED_FORM = 1e-4
"""Difference, in the metric's own unit, below which two errors against a closed form are equal: 0.1 mm, 0.1 mm/s, 0.1 ms. Smaller
ranks the rounding of motions that are sampled at sub-steps; larger hides what a reader can measure."""
LENGTH, ANGLE, SHARE, FRAMES = 1e-5, 1e-3, 0.05, 0.5
"""[m], [deg], [%] and [frames] below which nothing in a shown motion can be told apart."""
ENERGY = 1e-6
"""[J]: a ball of 0.1 kg lifted by a micrometre. Smaller ranks rounding, larger hides what overlap removal adds."""
KEPT = 0.01
"""Share of a way up to which two engines keep time alike: bodies that bounce more than once in a frame lack or add as much."""
PILE = 5.0
"""Difference [%] of the height of a heap below which two are level: where bodies come to lie is chance."""
TIME = 0.1
"""Share by which two times may differ and are level: by so much the same frames differ from run to run."""
RATIO = 1e-9
"""Drift of a conserved quantity as a share of it: below is the rounding of some hundred frames."""

RANKED: dict[str, Ranked] = {
    "residual_overlap_max": Ranked(1e-6, stays_inside=True),
    "residual_overlap_p95": Ranked(1e-6, stays_inside=True),
    "residual_overlap_mean": Ranked(1e-6, stays_inside=True),
    "overlap_frames": Ranked(SHARE, stays_inside=True),
    "substep_overlap_max": Ranked(1e-6, stays_inside=True),
    "wrong_side_frames": Ranked(FRAMES),
    "escaped_bodies": Ranked(SHARE),
    "not_finite_frames": Ranked(FRAMES),
    "tracker_offset_rms_free": Ranked(LENGTH, stays_inside=True),
    "tracker_offset_max": Ranked(LENGTH, stays_inside=True),
    "tracker_offset_rms": Ranked(LENGTH, stays_inside=True),
    "tracker_angle_rms_free": Ranked(ANGLE, stays_inside=True),
    "tracker_angle_rms": Ranked(ANGLE, stays_inside=True),
    "silent_offset_frames": Ranked(FRAMES, stays_inside=True),
    "chatter_frames": Ranked(SHARE, stays_inside=True),
    "reversal_p95": Ranked(LENGTH, stays_inside=True),
    "reversal_max": Ranked(LENGTH, stays_inside=True),
    "jitter_rms": Ranked(LENGTH, stays_inside=True),
    "jerk_ratio": Ranked(0.01, stays_inside=True),
    "still_frames": Ranked(0.5, stays_inside=True),
    "halted_frames": Ranked(FRAMES),
    "time_kept_error": Ranked(KEPT),
    "stalled_bodies": Ranked(100.0 * KEPT),
    "pose_jump_max": Ranked(ANGLE, stays_inside=True),
    "root_jump_max": Ranked(LENGTH, stays_inside=True),
    "link_jump_max": Ranked(LENGTH, stays_inside=True),
    "joint_limit_excess_max": Ranked(ANGLE, stays_inside=True),
    "reach_cone_excess_max": Ranked(ANGLE, stays_inside=True),
    "joint_gap_max": Ranked(1e-6),
    **{
        name: Ranked(CLOSED_FORM, is_truth_error=True) for name in (
            "restitution_error_max", "apex_error_max", "bounce_time_error_max", "zeno_end_error_max", "course_error_max",
            "velocity_error_max", "spin_error_max", "stop_distance_error_max", "stop_direction_error_max", "flip_time_error_max",
            "pivot_rate_error_max", "axis_spin_error_max", "precession_error_max", "wave_speed_error", "sag_error_max",
        )
    },
    "pivot_missing": Ranked(CLOSED_FORM),
    "travel_missing": Ranked(LENGTH),
    "wave_missing": Ranked(0.5),
    "pile_height_error_max": Ranked(PILE),
    "height_missing": Ranked(LENGTH),
    "grip_slip_max": Ranked(LENGTH),
    "pressed_sideways_max": Ranked(LENGTH),
    "drift_max": Ranked(1e-6),
    "towers_fallen": Ranked(0.5),
    "momentum_drift_max": Ranked(RATIO),
    "angular_momentum_drift_max": Ranked(RATIO),
    "energy_drift_max": Ranked(RATIO),
    "energy_gain_max": Ranked(RATIO),
    "energy_added_max": Ranked(ENERGY),
    "lift_height_max": Ranked(1e-6),
    "rest_energy_end": Ranked(ENERGY),
    **{f"frame_time_{name}": Ranked(0.0, share=TIME) for name in ("p50", "p95")},
    **{f"frame_time_{name}": Ranked(0.0, may_lack=True, share=TIME) for name in ("p99", "max")},
}
"""In the order in which a reader of losses wants them: what is seen first, then what is felt, then what is computed."""

KINDS: dict[str, tuple[str, ...]] = {
    "overlap": ("residual_overlap_max", "residual_overlap_p95", "residual_overlap_mean", "overlap_frames", "substep_overlap_max"),
    "distance from the user": (
        "tracker_offset_rms_free", "tracker_offset_max", "tracker_offset_rms", "tracker_angle_rms_free", "tracker_angle_rms",
        "silent_offset_frames"),
    "smoothness": (
        "chatter_frames", "jitter_rms", "reversal_p95", "reversal_max", "jerk_ratio", "still_frames", "pose_jump_max",
        "root_jump_max", "link_jump_max"),
    "limits": ("joint_limit_excess_max", "reach_cone_excess_max", "joint_gap_max"),
    "loose bodies (lift, energy that nothing explains, halts, drift, falls)": (
        "lift_height_max", "energy_added_max", "halted_frames", "time_kept_error", "stalled_bodies", "rest_energy_end",
        "drift_max", "towers_fallen", "wave_missing", "pile_height_error_max"),
    "grips": ("height_missing", "grip_slip_max", "pressed_sideways_max"),
    "conserved quantities": ("momentum_drift_max", "angular_momentum_drift_max", "energy_drift_max", "energy_gain_max"),
    "closed forms": (
        "restitution_error_max", "apex_error_max", "bounce_time_error_max", "zeno_end_error_max", "course_error_max",
        "velocity_error_max", "spin_error_max", "stop_distance_error_max", "stop_direction_error_max", "flip_time_error_max",
        "pivot_rate_error_max", "pivot_missing", "travel_missing", "axis_spin_error_max", "precession_error_max",
        "wave_speed_error", "sag_error_max"),
    "right side, finite numbers": ("wrong_side_frames", "escaped_bodies", "not_finite_frames"),
    "time": ("frame_time_p50", "frame_time_p95", "frame_time_p99", "frame_time_max"),
}
"""Every ranked metric in one kind, so that counts by kind add up to those of all. The metrics of the kinds of an avatar and of
time measure one thing in several ways: to lose one, or to win it, in five of them is no more than once."""

_RAW = "the same frames with the disturbances of a machine that does other things too; the least of all repeats is ranked"
_OWN_WORDS = "an engine counts it of itself and the others do not: to be silent would win; what it leads to is ranked"

UNRANKED: dict[str, str] = {
    "ratio_standing_max": "here larger is better; the number of fallen towers ranks the same towers",
    "status_frames": "how much an engine says of its own frames: to be silent would win; what is wrong with the frames is ranked",
    "contact_gap_p50": "a body that is inside what it touches keeps no gap: to overlap would win; overlap is ranked",
    "lift_energy_max": "the height of the lift ranks it; the same height is a thousand times the energy under a heavy body",
    "grasped_fall_end": "what a hand never reached stays as high as what it holds: to meet nothing would win",
    "free_frames": "a property of the scene and its tracker, the same for every engine",
    **{name: _RAW for name in ("frame_time_raw_p50", "frame_time_raw_p95", "frame_time_raw_p99", "frame_time_raw_max")},
    **{f"frame_time_{phase}_p50": "a part of the median frame time, in frames that need not be the same for every engine"
       for phase in ("moving", "resting")},
    "resting_frames": "what an engine shows at rest, not how well; what it costs is ranked as time",
    "frame_time_python_p50": "what it adds to the time of MuJoCo and PyBullet is this project's own adapter; it is shown "
                             "beside engine-only time",
    "warmup": "once per process, and most of it is the import of a package",
    "deterministic": "1 or 0, larger is better; a 0 is said where it occurs",
    **{name: _OWN_WORDS for name in ("waiting", "planning", "following", "out_of_work")},
    "run": "stands for a run without figures; such runs are listed by their state",
    "stage_share_": "shares of an engine's own time, 100 % in sum; the time itself is ranked",
    "_per_frame": "work as each engine counts it, in units of its own; what it costs is ranked as time",
}
"""Metrics and families of metrics that rank no engine, each with the reason. A reason goes without its full stop."""


def ranked(metric: str) -> Ranked | None:
    """How `metric` ranks engines; None if it does not. Raises UnknownName for one that is not in the registry."""
    if metric in RANKED:
        return RANKED[metric]
    why_not(metric)
    return None


def why_not(metric: str) -> str:
    """Why `metric` ranks no engine. Raises UnknownName for one that does, or that is not in the registry."""
    if metric in UNRANKED:
        return UNRANKED[metric]
    for part in FAMILIES:
        if metric not in METRICS and part in UNRANKED and (metric.startswith(part) or metric.endswith(part)):
            return UNRANKED[part]
    raise UnknownName("metric without a place in the ranking", metric, UNRANKED)
