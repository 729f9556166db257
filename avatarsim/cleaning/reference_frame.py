"""A reference posture before the recording, often a T-pose in frame 0: found, left out of cleaning and reported."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.cleaning.chords import Chords
from avatarsim.cleaning.result import Audit, Cleaned
from avatarsim.scene.carried import of_avatar
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import poses_of_links

Array = NDArray[np.float64]

LEAP_SPEED = 10.0
"""Mean speed [m/s] of links from frame 0 to frame 1 above which frame 0 may be a reference: twice that of a sprint.
Larger: a T-pose near the first posture is tracked, and limbs are thrown; smaller: fast clips lose their first frame."""

LEAP_RATIO = 3.0
"""Factor of the mean speed to the next frame above which it is a leap: in recorded motion it is at most twice as much."""


def reference_frames(chords: Chords, motion: Motion) -> int:
    """Return 1 where frame 0 is a reference posture, else 0; only the first three frames decide."""
    if len(motion) < 3:
        return 0
    first, second = _steps(chords, motion).mean(axis=1) / np.diff(motion.times[:3])
    return int(first > LEAP_SPEED and first > LEAP_RATIO * second)


def _steps(chords: Chords, motion: Motion) -> Array:
    """Return how far (2, links) [m] links move in the first two steps."""
    avatar = chords.scene.avatars[0]
    own = of_avatar(motion, avatar)
    places, _ = poses_of_links((avatar,), own.positions[:3], own.rotations[:3], own.angles[:3])
    return np.asarray(np.linalg.norm(np.diff(places, axis=0), axis=2))


def note_of(chords: Chords, motion: Motion) -> str:
    """Return a sentence on the reference posture in frame 0."""
    far = 1e3 * float(_steps(chords, motion)[0].max())
    return f"frame 0 is a reference posture, {far:.0f} mm from frame 1: it stays as recorded, and no measure includes it"


def audit_with_reference(audit: Audit, note: str) -> Audit:
    """Return the audit of a motion with a frame before its first, which no measure includes."""
    return replace(
        audit, depths=np.concatenate([[0.0], audit.depths]), proven=np.concatenate([[1.0], audit.proven]),
        notes=(note, *audit.notes), pairs=(None, *audit.pairs),
    )


def cleaned_with_reference(cleaned: Cleaned, motion: Motion, note: str) -> Cleaned:
    """Return the cleaned motion with frame 0 of the avatar's input before it."""
    done, none = cleaned.motion, np.array([False])
    parts = (np.concatenate([getattr(motion, name)[:1], getattr(done, name)]) for name in ("positions", "rotations", "angles"))
    return replace(
        cleaned, motion=Motion(motion.times, *parts), before=audit_with_reference(cleaned.before, note),
        after=audit_with_reference(cleaned.after, note), changed=np.concatenate([none, cleaned.changed]),
        held=np.concatenate([none, cleaned.held]),
        flagged=tuple(replace(one, first=one.first + 1, last=one.last + 1) for one in cleaned.flagged),
    )
