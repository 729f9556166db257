"""The bounds that nearly every scene shares, each with its reason."""

from scenarios.scenario import Bound

NO_OVERLAP = Bound("residual_overlap_max", 1e-6, "nothing shown may overlap; 1e-6 m is a hundred times the judge's own error")
RIGHT_SIDE = Bound("wrong_side_frames", 0.0, "a body behind a wall went through it")
FINITE = Bound("not_finite_frames", 0.0, "a pose that is not a number cannot be shown")
WITHIN_LIMITS = Bound("joint_limit_excess_max", 1e-9, "limits hold exactly; 1e-9 degrees is the rounding of poses to angles")
WITHIN_CONES = Bound("reach_cone_excess_max", 1e-9, "cones hold exactly; 1e-9 degrees is the rounding of poses to angles")
KEEPS_MOVING = Bound("still_frames", 1.0, "the avatar answers its user: an engine that freezes never overlaps, and is useless")
FOLLOWS_WHEN_FREE = Bound(
    "tracker_offset_rms_free", 5e-3,
    "with nothing in the way the avatar is where its user is; what comes free at 1 m/s lags by up to 7 mm for 0.1 s",
)

NO_LEAP = Bound("pose_jump_max", 15.0, "a limb that catches up is seen to turn: at 60 Hz 15 degrees are 16 rad/s more")
NO_LEAP_OF_THE_ROOT = Bound("root_jump_max", 0.1, "a body that catches up is seen to go: at 60 Hz 0.1 m is 6 m/s more")
NO_SHAKING = Bound("chatter_frames", 1.0, "a link that goes to and fro before a wall while its user does not is seen first")
SAYS_SO = Bound("silent_offset_frames", 0.0, "an avatar that is kept from a free user reports it, so that a program can tell")

KEEPS_TIME = Bound("time_kept_error", 0.02, "bodies move as their velocities state; engines with fixed steps lack 0.4 %")
NEVER_STALLS = Bound("stalled_bodies", 0.0, "no body hangs where it is while its velocity states that it flies")
GAINS_NOTHING = Bound("energy_gain_max", 1e-6, "impacts, friction and rest take energy")
NO_ENERGY = Bound("energy_gain_max", 1e-9, "impacts and friction take energy")

SOUND = (NO_OVERLAP, RIGHT_SIDE, FINITE)
"""Poses are numbers, overlap nothing, and are on the right side of everything."""
MOVES = (KEEPS_MOVING, NO_LEAP, NO_LEAP_OF_THE_ROOT, NO_SHAKING, SAYS_SO)
"""Promises on moving: an avatar follows its user, never jumps, does not shake, and reports its obstacle."""
HAND = (*SOUND, *MOVES, FOLLOWS_WHEN_FREE)
"""Promises of a rigid hand."""
AVATAR = (*SOUND, WITHIN_LIMITS, *MOVES, FOLLOWS_WHEN_FREE)
"""Promises of every scene with an articulated avatar."""
CROWD = (*SOUND, KEEPS_TIME, NEVER_STALLS)
"""Promises of every scene in which many bodies move and touch."""
