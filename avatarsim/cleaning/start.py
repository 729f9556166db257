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
"""Duration [s] of one step of the approach to the first posture; steps in which the user is led there from the free posture; most
steps; and motion [rad, m] below which everything is at rest."""


def free_posture(chords: Chords, sample: TrackerSample, margin: float) -> TrackerSample:
    """Return the posture nearest to `sample` with all pairs at least `margin` [m] apart, else one with them apart at all.
    Raises StartOverlaps where none is found."""
    clipped, _ = chords.clipped(sample)
    world = chords.world
    target, search = posture_of(world.skeleton, world.hinges, clipped), Postures(world)
    for gap in (margin, WEDGED_SHARE * margin):
        if search.nearest(target, gap, True):
            found = chords.clipped(shown_sample(world, sample.time))[0]
            if chords.nearest(found, margin)[0] > 0.0:
                return chords.with_moving_bodies(found, sample)
    depth, pair = chords.nearest(clipped, margin)
    raise StartOverlaps([(*(pair or ("", "")), -depth)])


def approach(follower: "Follower", sample: TrackerSample) -> TrackerSample:
    """Lead the user from the avatar's posture to `sample`, wait until nothing moves any more, and return the avatar's posture."""
    start = follower.shown
    follower.is_input = False
    for look in range(LOOKS):
        last, shares = follower.shown, (min(1.0, (look + k) / LED) for k in (0, 1))
        before, after = (between(start, sample, share) for share in shares)
        follower.follow(replace(before, time=0.0), replace(after, time=PACE), False)
        if look >= LED and difference(follower.chords, last, follower.shown) < STILL:
            break
    return follower.shown
