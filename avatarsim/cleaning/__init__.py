"""Recorded motions made free of overlap within joint limits, each written frame and the way between frames proved."""

from collections.abc import Callable, Sequence

from avatarsim.assets.models.model import Model
from avatarsim.cleaning.result import Array, Audit, Cleaned, Excluded, Flagged, Moved, Opinion, Options
from avatarsim.scene.body import Body
from avatarsim.scene.motion import Motion

__all__ = ["Audit", "Cleaned", "Excluded", "Flagged", "Moved", "Opinion", "Options", "Shield", "audit", "clean"]


def clean(
    motion: Motion, model: Model, room: Sequence[Body] = (), options: Options = Options(), progress: Callable[[float], None] | None = None
) -> Cleaned:
    """The nearest motion to `motion` without overlap and within limits. `progress` is called with the share that is done, 0 to 1.

    Raises InvalidInput for a model without avatar, StartOverlaps where no free posture is found to start from."""
    raise NotImplementedError


def audit(motion: Motion, model: Model, room: Sequence[Body] = (), options: Options = Options()) -> Audit:
    """Measures of a motion as it is."""
    raise NotImplementedError


class Shield:
    """Generalized coordinates in, certified ones out, frame by frame (for teleoperation)."""

    def __init__(self, model: Model, room: Sequence[Body] = (), rate: float = 60.0, options: Options = Options()) -> None:
        raise NotImplementedError

    def __call__(self, q: Array) -> Array:
        """The nearest free posture to q (width,) that is reached on a free way from the last one."""
        raise NotImplementedError
