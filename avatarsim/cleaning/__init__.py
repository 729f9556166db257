"""Recorded motions made free of overlap within joint limits, each written frame and the way between frames proved."""

from collections.abc import Callable, Sequence

from avatarsim.assets.models.model import Model
from avatarsim.cleaning.result import DEFAULTS, AtRest, Audit, Cleaned, Excluded, Flagged, Moved, Opinion, Options
from avatarsim.cleaning.stream import Shield
from avatarsim.cleaning.whole_clip import audit_motion, clean_motion
from avatarsim.scene.body import Body
from avatarsim.scene.carried import Carried
from avatarsim.scene.motion import Motion

__all__ = [
    "AtRest", "Audit", "Carried", "Cleaned", "Excluded", "Flagged", "Moved", "Opinion", "Options", "Shield", "audit", "clean",
]


def clean(
    motion: Motion, model: Model, room: Sequence[Body] = (), options: Options = DEFAULTS,
    progress: Callable[[float], None] | None = None, carried: Sequence[Carried] = (),
) -> Cleaned:
    """The nearest motion to `motion` that is found free of overlap and within limits, in each frame and on the way between
    frames.

    The avatar is the model's; it meets the model's bodies and those of `room`, which stand still, and what is `carried`, whose
    recorded poses stay as they are. Frames that are free, and that
    are reached on a free way, stay as they are, to the bit. `progress` is called with the share that is done, 0 to 1. Method and
    sources: docs/cleaning.md.

    Raises InvalidInput for a model without avatar and a motion that does not fit it, StartOverlaps where no free posture is found
    near the first one.
    """
    return clean_motion(motion, model, room, options, progress, carried)


def audit(
    motion: Motion, model: Model, room: Sequence[Body] = (), options: Options = DEFAULTS, carried: Sequence[Carried] = ()
) -> Audit:
    """Measures of a motion as it is: overlap in frames and proof between them, limits, jerk, and what is excluded from all that.

    Raises InvalidInput for a model without avatar and a motion that does not fit it.
    """
    return audit_motion(motion, model, room, options, carried)
