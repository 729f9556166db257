"""The bounds that nearly every scene shares, each with its reason."""

from scenarios.scenario import Bound

NO_OVERLAP = Bound(
    "residual_overlap_max", 1e-6,
    "nothing shown may overlap; 1e-6 m is a hundred times the judge's own error, and invisible",
)
RIGHT_SIDE = Bound("wrong_side_frames", 0.0, "who is found behind a wall went through it")
FINITE = Bound("not_finite_frames", 0.0, "a pose that is not a number cannot be shown")
WITHIN_LIMITS = Bound(
    "joint_limit_excess_max", 1e-9,
    "limits hold exactly; 1e-9 degrees is the rounding of turning poses back into angles",
)
KEEPS_MOVING = Bound(
    "still_frames", 1.0,
    "the shown avatar answers its user: an engine that freezes never overlaps, and is useless",
)
FOLLOWS_WHEN_FREE = Bound(
    "tracker_offset_rms_free", 1e-3,
    "where nothing is in the way the avatar is where the user is, to a millimetre",
)

NO_LEAP = Bound(
    "pose_jump_max", 90.0,
    "no joint turns by more than a quarter turn a frame beyond the user's own: a limb gets elsewhere on a way that is seen",
)
NO_LEAP_OF_THE_ROOT = Bound(
    "root_jump_max", 0.4,
    "a body goes after its user by no more than 0.4 m a frame beyond the user's own way, and never through what is between",
)

MOVES = (KEEPS_MOVING, NO_LEAP, NO_LEAP_OF_THE_ROOT)
"""An avatar answers its user, and is never suddenly elsewhere."""
AVATAR = (NO_OVERLAP, RIGHT_SIDE, FINITE, WITHIN_LIMITS, *MOVES, FOLLOWS_WHEN_FREE)
"""What every scene with an articulated avatar promises."""
