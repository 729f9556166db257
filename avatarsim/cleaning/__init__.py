"""Recorded motions freed of overlap within joint limits, with each written frame and the motion between frames proved."""

from collections.abc import Callable, Sequence

from avatarsim.assets.models.model import Model
from avatarsim.cleaning.chords import Room
from avatarsim.cleaning.result import DEFAULTS, AtRest, Audit, Cleaned, Excluded, Flagged, Moved, Opinion, Options
from avatarsim.cleaning.stream import Shield
from avatarsim.cleaning.whole_clip import audit_motion, clean_motion
from avatarsim.scene.carried import Carried
from avatarsim.scene.motion import Motion

__all__ = [
    "AtRest", "Audit", "Carried", "Cleaned", "Excluded", "Flagged", "Moved", "Opinion", "Options", "Shield", "audit", "clean",
]


def clean(
    motion: Motion, model: Model, room: Room = (), options: Options = DEFAULTS,
    progress: Callable[[float], None] | None = None, carried: Sequence[Carried] = (),
) -> Cleaned:
    """Return the nearest motion to `motion` that is found free of overlap and within limits, in frames and between them.

    The avatar is the model's; it meets the model's bodies and those of `room`, which are fixed, and `carried` bodies, whose
    recorded poses stay as they are. Frames that are free, and that are reached by a free motion, stay as they are, to the bit.
    `progress` is called with the finished share, 0 to 1. Method and sources: docs/cleaning.md.

    Raises InvalidInput for a model without avatar and a motion that does not fit it, StartOverlaps where no free posture is found
    near the first one.
    """
    return clean_motion(motion, model, room, options, progress, carried)


def audit(
    motion: Motion, model: Model, room: Room = (), options: Options = DEFAULTS, carried: Sequence[Carried] = ()
) -> Audit:
    """Measure a motion as it is: overlap in frames and proof between them, limits, jerk, and the pairs excluded from all that.

    Raises InvalidInput for a model without avatar and a motion that does not fit it.
    """
    return audit_motion(motion, model, room, options, carried)
