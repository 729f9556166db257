"""Where tracking starts: the first free frame; without any, the free posture nearest to the first frame's (`free_start`)."""

from dataclasses import replace
from typing import TYPE_CHECKING

from avatarsim.cleaning.chords import Chords, between, difference
from avatarsim.errors import StartOverlaps
from avatarsim.free_start import Postures
from avatarsim.model.world import posture_of, shown_sample
from avatarsim.scene.tracker import TrackerSample
from avatarsim.tolerances import WEDGED_SHARE

if TYPE_CHECKING:
    from avatarsim.cleaning.track import Follower

PACE, LED, LOOKS, STILL = 1.0 / 60.0, 60, 120, 1e-6
"""[s] of one look at the approach to the first posture; looks in which the user is led there from the free posture; looks at
most; and [rad, m] of what then moves no more."""


def free_posture(chords: Chords, sample: TrackerSample, margin: float) -> TrackerSample:
    """The posture nearest to `sample` that keeps all pairs at least `margin` [m] apart, else one that keeps them apart at all;
    raises StartOverlaps where none is found."""
    clipped, _ = chords.clipped(sample)
    world = chords.world
    target, search = posture_of(world.skeleton, world.hinges, clipped), Postures(world)
    for gap in (margin, WEDGED_SHARE * margin):
        if search.nearest(target, gap, True):
            found = chords.clipped(shown_sample(world, sample.time))[0]
            if chords.nearest(found, margin)[0] > 0.0:
                return chords.with_given(found, sample)
    depth, pair = chords.nearest(clipped, margin)
    raise StartOverlaps([(*(pair or ("", "")), -depth)])


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
