"""Every metric: its unit and what it means, in the words that `python -m scenarios metrics` prints."""

from avatarsim.errors import UnknownName
from runfiles.timing_protocol import PHASE_FRAMES, REPEATS, TAIL_FRAMES, WARM_FRAMES
from runfiles.visible_motion import STILL

METRICS: dict[str, tuple[str, str]] = {
    "residual_overlap_max": ("m", "largest penetration over all pairs that the scene filters in, over all states shown"),
    "residual_overlap_p95": ("m", "the same per state shown, 95th percentile"),
    "residual_overlap_mean": ("m", "the same, mean"),
    "overlap_frames": ("%", "states shown with more than 1e-6 m of penetration"),
    "substep_overlap_max": ("m", "largest penetration at a sub-step or event inside a frame"),
    "wrong_side_frames": ("frames", "frames, sub-steps included, in which something is outside its declared region"),
    "restitution_error_max": ("", "largest |v+/v- - e| of an impact faster than 0.3 m/s"),
    "apex_error_max": ("m", "largest |apex - e^(2n) h| over the bounces whose expected apex is at least 1 mm"),
    "bounce_time_error_max": ("s", "largest difference of an impact's time from the closed form's, impacts faster than 0.1 m/s"),
    "zeno_end_error_max": ("s", "largest difference of the end of an endless sequence of bounces from sqrt(2h/g)(1+e)/(1-e)"),
    "course_error_max": ("m", "largest distance of a body from its closed-form place, over all states shown"),
    "velocity_error_max": ("m/s", "largest difference of a body's velocity from the closed form, over all states shown"),
    "spin_error_max": ("rad/s", "largest difference of a body's angular velocity from the closed form, over all states shown"),
    "drift_max": ("m", "farthest that a body which should rest is from where it came to rest"),
    "rest_energy_end": ("J", "kinetic energy at the end of all bodies that should rest"),
    "towers_fallen": ("towers", "towers of a heavy body on a light one that do not stand to a millimetre"),
    "ratio_standing_max": ("", "largest ratio of masses of which, and of all below, those towers stand"),
    "momentum_drift_max": ("", "largest |P - P0| of bodies that nothing else touches, over the first sum of m |v|"),
    "angular_momentum_drift_max": ("", "largest |L - L0| about their common centre, over the largest sum of the bodies' shares"),
    "energy_drift_max": ("", "largest |E - E0| of bodies that lose nothing, over their largest kinetic energy"),
    "energy_gain_max": ("", "largest rise of kinetic and potential energy of one group of bodies in one frame, over its largest "
                        "kinetic energy"),
    "stop_distance_error_max": ("%", "largest difference of a sliding body's way from v^2 / (2 mu g)"),
    "stop_direction_error_max": ("deg", "largest angle between that way and the first velocity"),
    "flip_time_error_max": ("s", "largest difference of a flip about the middle axis from the closed form"),
    "pivot_rate_error_max": ("rad/s", "largest difference of a falling rod's angular speed from what energy allows at its angle"),
    "pivot_missing": ("rad", "by how much a falling rod fell short of the angle that it is to reach"),
    "halted_frames": ("frames", "frames in which a simulated body has speed at both ends and was not moved"),
    "time_kept_error": ("", "|1 - k|, k the way that simulated bodies faster than 0.02 m/s go along what their shown velocities "
                        "state, over that; of all ways that one impact in a frame could make of the velocities at its two ends "
                        "the nearest is taken"),
    "stalled_bodies": ("%", "share of those bodies and frames in which a body goes less than a fifth of that way, in three "
                       "frames in a row at least"),
    "status_frames": ("frames", "frames that the engine itself reports as not ended well"),
    "escaped_bodies": ("%", "bodies that were ever outside the region declared for them"),
    "travel_missing": ("m", "how far pushed bodies fell short of the way that the scene states for them"),
    "axis_spin_error_max": ("rad/s", "largest difference of a top's spin about its own axis from what it began with"),
    "precession_error_max": ("rad/s", "difference of the mean rate at which a top's axis goes round from the closed form"),
    "wave_speed_error": ("%", "difference of the speed of a wave through a row of dominoes from the stated one"),
    "wave_missing": ("bodies", "bodies of such a row that did not fall"),
    "pile_height_error_max": ("%", "largest difference of the mean height of a heap at rest from the stated one"),
    "height_missing": ("m", "by how much a carried body rose less than its user"),
    "grip_slip_max": ("m", "farthest that a carried body has moved in the frame of a link that carries it"),
    "pressed_sideways_max": ("m", "farthest that a body pressed straight down has gone sideways"),
    "sag_error_max": ("m", "largest distance of a loaded link from where equation 6 has it: load over spring below its user"),
    "joint_limit_excess_max": ("deg", "largest angle beyond a hinge's limits or a ball's swing and twist, from poses"),
    "joint_gap_max": ("m", "largest distance of a link from where its joint holds it on its parent"),
    "reach_cone_excess_max": ("deg", "largest angle by which a limb points outside its reach cone"),
    "tracker_offset_max": ("m", "largest distance of a link origin from the raw tracker's, over all frames"),
    "tracker_offset_rms": ("m", "root mean square distance of link origins from the raw tracker's"),
    "tracker_offset_rms_free": ("m", "the same over frames in which the raw posture overlaps nothing, is within its limits "
                                "and on the right side"),
    "free_frames": ("%", "share of those frames: what the _free figures stand on"),
    "tracker_angle_rms": ("deg", "root mean square angle of joints from the raw tracker's"),
    "tracker_angle_rms_free": ("deg", "the same over those free frames"),
    "still_frames": ("%", "frames in which the tracker moves more than 1 mm and nothing shown of the avatar moves"),
    "pose_jump_max": ("deg", "largest change of a joint from frame to frame beyond the tracker's own largest"),
    "root_jump_max": ("m", "largest way of a free root from frame to frame beyond the tracker's own"),
    "link_jump_max": ("m", "largest way of a link origin from frame to frame beyond its own target's"),
    "chatter_frames": ("%", "share of the frames in contact (raw posture not free, or a shown link at most 5 mm from what it may "
                       "not overlap) in which a link shakes: in 3 of the last 4 frames its origin moved faster than 0.18 m/s (3 "
                       "mm at 60 Hz) against its motion of the frame before, as fast, and its target did not turn back"),
    "reversal_p95": ("m", "95th percentile over frames in contact of the largest displacement that a link took back while its "
                     "target did not turn back: the smaller of the two displacements"),
    "reversal_max": ("m", "the largest such displacement of any frame, in contact or not"),
    "jitter_rms": ("m", "of the link that has most: root mean square, over frames in contact in which its target moves slower "
                   "than 0.18 m/s (rests or slides), of the displacement taken back, where none was 0, where it was faster than "
                   "that 3 mm at 60 Hz: in few frames one such event decides"),
    "contact_gap_p50": ("m", "median, over the states in which a link is within 5 mm of what it may not overlap, of that "
                        "distance, an overlap counting as 0: how far an avatar that touches seems to hover; in everyday scenes"),
    "jerk_ratio": ("", "95th percentile of the third differences of link origins, shown over target; a target below 20 m/s^3 "
                   "counts as that"),
    "silent_offset_frames": ("frames", "the raw posture has been free for half a second, a link origin is shown more than 10 cm "
                             "from it, and the engine reports no status; an engine without statuses has all such frames"),
    "energy_added_max": ("J", "largest gain of kinetic energy that nothing explains: of a frame with no driven link near, of an "
                         "impact, links included"),
    "lift_energy_max": ("J", "largest potential energy of a frame gained by being moved up without the velocity for it"),
    "lift_height_max": ("m", "the largest height of such a lift of one body in one frame"),
    "grasped_fall_end": ("m", "how far below its first place a thing that a hand grasps is at the end: 0 on its pedestal or in "
                         "the hand, more where it slipped out and fell"),
    "not_finite_frames": ("frames", "states shown in which something is nan or infinite"),
    "frame_time_p50": ("us", "median time of a rendered frame, engine only, each frame the least of its repeats, over the "
                       "repeats and frames that every engine of the scene had"),
    "frame_time_p95": ("us", "the same, 95th percentile"),
    "frame_time_p99": ("us", "99th percentile of all frames that this engine had, each the least of its repeats; only from "
                       f"{REPEATS} x {TAIL_FRAMES} frames on"),
    "frame_time_max": ("us", "the same, slowest frame; of a scene that was timed whole from any number of frames on"),
    "frame_time_raw_p50": ("us", "median over the frames of frame_time_p50 in every one of its repeats, disturbances included"),
    "frame_time_raw_p95": ("us", "the same, 95th percentile"),
    "frame_time_raw_p99": ("us", "99th percentile over the frames of frame_time_p99 in every repeat, disturbances included"),
    "frame_time_raw_max": ("us", "the same, slowest frame"),
    "frame_time_python_p50": ("us", "frame_time_p50 as called from Python: with the Python round the engine"),
    "frame_time_moving_p50": ("us", "frame_time_p50 over frames in which a body or link moves faster than "
                              f"{1e3 * STILL:g} mm/s, where there are {PHASE_FRAMES} of these and of the others"),
    "frame_time_resting_p50": ("us", "the same over the other frames"),
    "resting_frames": ("%", "share of those frames in which nothing moves faster: an engine that sleeps when all rests does "
                       "so in the median frame from half of them on"),
    "warmup": ("s", f"import, load and the first {WARM_FRAMES} frames in a fresh process"),
    "deterministic": ("", "1 when all repeats and the accuracy pass, in processes of their own, reached the same bits; else 0"),
    "waiting": ("frames", "an avatar that is held off its target makes no progress, and no path is sought or known; summed over "
                "avatars"),
    "planning": ("frames", "the same, and a path is being sought"),
    "following": ("frames", "an avatar is led along a path"),
    "out_of_work": ("", "steps that ended because the work of the frame was spent"),
    "run": ("", "stands in for all metrics of a run that gave none: crashed, not measured, refused"),
}
FAMILIES: dict[str, tuple[str, str]] = {
    "stage_share_": ("%", "share of a stage in the engine's time (stage_share_<stage>)"),
    "_per_frame": ("", "work per frame as the engine counts it (<name>_per_frame): joints, iterations, pairs, ..."),
}


def unit(metric: str) -> str:
    """Unit of `metric`; UnknownName for one that is not defined."""
    if metric in METRICS:
        return METRICS[metric][0]
    for part, (name, _) in FAMILIES.items():
        if metric.startswith(part) or metric.endswith(part):
            return name
    raise UnknownName("metric", metric, METRICS)
