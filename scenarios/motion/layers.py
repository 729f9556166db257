"""Two recorded motions in one body, as animators layer them: the legs of one clip under the upper body of another."""

from dataclasses import replace

import numpy as np

from avatarsim.assets.motions.deepmimic import Clip
from avatarsim.errors import InvalidInput

UPPER = ("chest", "neck", "right_shoulder", "right_elbow", "left_shoulder", "left_elbow")
"""Links that the upper layer moves. The root belongs to the legs, which carry it."""


def upper_body_of(above: Clip, start: float, below: Clip) -> Clip:
    """`below` with chest, neck and arms as in `above` from `start` [s] on; both retimed to the same steps.

    Raises InvalidInput when `above` ends before `below` does.
    """
    first = int(np.searchsorted(above.times, start - 1e-9))
    taken = slice(first, first + len(below.times))
    if len(above.times[taken]) < len(below.times):
        latest = above.times[-1] - below.times[-1]
        raise InvalidInput(f"start of clip {above.name} over clip {below.name} [s]", start, f"at most {latest:g}")
    return replace(
        below,
        name=f"{below.name} under {above.name}",
        rotations={link: (above.rotations[link][taken] if link in UPPER else kept) for link, kept in below.rotations.items()},
        angles={link: (above.angles[link][taken] if link in UPPER else kept) for link, kept in below.angles.items()},
    )
