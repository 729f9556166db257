"""Where tracking starts: the first free frame; without any, a free posture near the first frame's, found by lifting the root.

Postures between the first frame's and that of the model's start, or at rest, are looked at as well, since no lift helps an avatar
that overlaps itself.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from avatarsim.cleaning.chords import Chords, between, difference
from avatarsim.errors import StartOverlaps
from avatarsim.scene.tracker import TrackerSample

if TYPE_CHECKING:
    from avatarsim.cleaning.track import Follower

LIFTS = (0.0, *(1e-3 * 2.0**k for k in range(13)))
"""[m] how far a root is moved, to 4 m: a doubling finds a place of any size in as many looks."""

SHARES = (0.0, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Shares of the way to the model's start."""

DIRECTIONS = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0))
"""Where a root is moved: upwards first, out of the ground."""

PACE, LED, LOOKS, STILL = 1.0 / 60.0, 60, 120, 1e-6
"""[s] of one look at the approach to the first posture; looks in which the user is led there from the free posture; looks at
most; and [rad, m] of what then moves no more."""


def candidates(chords: Chords, sample: TrackerSample) -> Iterator[TrackerSample]:
    """Postures near one, nearest first."""
    clipped, _ = chords.clipped(sample)
    at_rest = replace(chords.scene.first_sample, positions=sample.positions)
    at_rest = replace(at_rest, rotations=at_rest.rotations.copy())
    kept = [*chords.free_roots, *chords.given]
    at_rest.rotations[kept] = sample.rotations[kept]
    at_rest, _ = chords.clipped(at_rest)
    has_root = len(chords.free_roots) > 0
    for share in SHARES:
        mixed, _ = chords.clipped(between(clipped, at_rest, share) if share > 0.0 else clipped)
        for lift in LIFTS if has_root else LIFTS[:1]:
            for direction in DIRECTIONS if lift > 0.0 else DIRECTIONS[:1]:
                positions = mixed.positions.copy()
                positions[chords.free_roots] += lift * np.array(direction)
                yield chords.with_given(replace(mixed, positions=positions), sample)


def free_posture(chords: Chords, sample: TrackerSample, margin: float) -> TrackerSample:
    """A posture near `sample` that keeps all pairs at least `margin` [m] apart, else one that keeps them apart at all; raises
    StartOverlaps where none is found."""
    touching: TrackerSample | None = None
    for candidate in candidates(chords, sample):
        gap, _ = chords.nearest(candidate, margin)
        if gap >= margin:
            return candidate
        if gap > 0.0 and touching is None:
            touching = candidate
    if touching is not None:
        return touching
    gap, pair = chords.nearest(chords.clipped(sample)[0], margin)
    raise StartOverlaps([(*(pair or ("", "")), -gap)])


def approach(follower: "Follower", sample: TrackerSample) -> TrackerSample:
    """Lead the user from where the avatar is to `sample`, and wait until nothing moves any more; where the avatar is then."""
    start = follower.shown
    follower.is_input = False
    for look in range(LOOKS):
        last, shares = follower.shown, (min(1.0, (look + k) / LED) for k in (0, 1))
        before, after = (between(start, sample, share) for share in shares)
        follower.follow(replace(before, time=0.0), replace(after, time=PACE), False)
        if look >= LED and difference(follower.chords, last, follower.shown) < STILL:
            break
    return follower.shown
