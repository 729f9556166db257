"""Measures of a motion: overlap in frames and proof between them, excess beyond limits, jerk, and distance from another motion.

Jerk: third differences of link positions over the time of a frame cubed (Flash and Hogan 1985 judge the smoothness of human
motion by it).
"""

from collections.abc import Sequence
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from avatarsim.cleaning.chords import Chords, certified
from avatarsim.cleaning.foot_contact import foot_slide
from avatarsim.cleaning.result import OVERLAP, AtRest, Audit, Excluded, Moved
from avatarsim.cleaning.second_opinion import opinion_of
from avatarsim.cleaning.track import Judged
from avatarsim.scene.carried import of_avatar
from avatarsim.scene.joint import Hinges, Slide, axes_of
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

HIGH = 95.0
"""Percentile of the sorted values that is reported."""

NAMED = 8
"""Most excluded pairs in a sentence, the deepest; all are in the audit."""


def jerk(chords: Chords, motion: Motion) -> Array:
    """Return the size (F, links) [m/s^3] of the third difference of positions of the avatar's links about each frame.
    It is nan where there are too few frames."""
    avatar = chords.scene.avatars[0]
    own = of_avatar(motion, avatar)
    positions, _ = poses_of_links((avatar,), own.positions, own.rotations, own.angles)
    found = np.full(positions.shape[:2], np.nan)
    if len(motion) >= 4:
        third = np.linalg.norm(np.diff(positions, 3, axis=0), axis=2) * motion.rate**3
        # of the middle two of four frames
        found[1:-2] = third
    return found


def high(values: Array) -> float:
    """Return the 95th percentile of the finite values; nan of none."""
    known = values[np.isfinite(values)]
    return float(np.percentile(known, HIGH)) if known.size else float("nan")


def audited(
    chords: Chords, motion: Motion, judged: Judged, was_free: Flags, planted: Flags, with_opinion: bool,
    notes: tuple[str, ...] = (),
) -> Audit:
    """Return the measures of a motion whose frames were judged.
    `was_free` (F,): which frames of the input were free; `planted` (F-1, feet): between which frames its feet were planted."""
    jerks = jerk(chords, motion)
    deepest = int(np.argmin(judged.gap))
    depths = np.maximum(0.0, -judged.gap)
    excluded, warnings = excluded_pairs(chords, motion), []
    blind = sorted((one for one in excluded if one.depth > OVERLAP), key=lambda one: -one.depth)
    if blind:
        named = ", ".join(f"{one.a} and {one.b} ({1e3 * one.depth:.1f} mm)" for one in islice(blind, NAMED))
        more = f" and {len(blind) - NAMED} more" if len(blind) > NAMED else ""
        warnings.append(f"excluded pairs that overlap, which no measure counts and no proof looks at: {named}{more}")
    opinion, why = opinion_of(chords.scene, motion) if with_opinion else (None, "")
    if why:
        warnings.append(why)
    return Audit(
        depths, judged.pair[deepest] if depths[deepest] > 0.0 else None, certified(chords, motion, -OVERLAP).until,
        float(judged.beyond[:, 0].max()), float(judged.beyond[:, 1].max()), high(jerks[was_free]), high(jerks[~was_free]),
        excluded, opinion, tuple(warnings), at_rest_pairs(chords, motion), foot_slide(chords, motion, planted), notes,
        tuple(pair if depth > OVERLAP else None for pair, depth in zip(judged.pair, depths, strict=True)),
    )


def excluded_pairs(chords: Chords, motion: Motion) -> tuple[Excluded, ...]:
    """Return the pairs that avatar and model exclude, except each link and its parent, and their depths of overlap."""
    scene, avatar, names = chords.scene, chords.scene.avatars[0], chords.scene.names
    at = {link.name: len(scene.bodies) + k for k, link in enumerate(avatar.links)}
    found = [(at[a], at[b]) for a, b in avatar.ignore] + [(names.index(a), names.index(b)) for a, b in scene.exclude]
    pairs = sorted({(min(pair), max(pair)) for pair in found})
    depths = deepest_of(chords, motion, pairs)
    return tuple(Excluded(names[a], names[b], depth) for (a, b), depth in zip(pairs, depths, strict=True))


def at_rest_pairs(chords: Chords, motion: Motion) -> tuple[AtRest, ...]:
    """Return the pairs that overlap at home and must not overlap deeper, and their depths of overlap."""
    scene = chords.scene
    known = [(a, b, allowed) for a, b, allowed in scene.resting if scene.pair_filter[a, b]]
    found = deepest_of(chords, motion, [(a, b) for a, b, _ in known])
    return tuple(
        AtRest(scene.names[a], scene.names[b], allowed, depth) for (a, b, allowed), depth in zip(known, found, strict=True)
    )


def deepest_of(chords: Chords, motion: Motion, pairs: Sequence[tuple[int, int]]) -> list[float]:
    """Return the deepest overlap [m] of pairs of bodies, by their numbers, in any frame; 0 for none."""
    numbers, depths = np.array(pairs, dtype=np.int64).reshape(-1, 2), np.zeros(len(pairs))
    for frame in range(len(motion) if pairs else 0):
        depths = np.maximum(depths, -chords.gaps(motion.sample(frame), numbers))
    return [float(depth) for depth in depths]


def link_moves(chords: Chords, motion: Motion, written: Motion) -> Array:
    """Return the distances (F, links) [m] of the middles of the avatar's links in a written motion from those of the input."""
    avatar = chords.scene.avatars[0]
    motion, written = of_avatar(motion, avatar), of_avatar(written, avatar)
    before, after = (poses_of_links((avatar,), one.positions, one.rotations, one.angles) for one in (motion, written))
    middles = np.array([
        np.mean([piece.position for piece in link.pieces], axis=0) if link.pieces else np.zeros(3) for link in avatar.links
    ])
    places = [at + rotation.rotate(turns, np.broadcast_to(middles, at.shape)) for at, turns in (before, after)]
    return np.asarray(np.linalg.norm(places[1] - places[0], axis=2))


def farthest(chords: Chords, motion: Motion, written: Motion) -> float:
    """Return the largest distance [m] of any link between the input and a written motion."""
    return float(link_moves(chords, motion, written).max())


def moved(chords: Chords, motion: Motion, written: Motion) -> Moved:
    """Return the distances of the written motion of the avatar from the input."""
    away, avatar = link_moves(chords, motion, written), chords.scene.avatars[0]
    motion, written = of_avatar(motion, avatar), of_avatar(written, avatar)
    turns = rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(motion.rotations), written.rotations))
    names, columns, slides = [], [], []
    hinge = 0
    ways = np.abs(written.angles - motion.angles)
    for k, link in enumerate(avatar.links):
        if k in chords.turning:
            names.append(link.name)
            columns.append(np.linalg.norm(turns[:, k], axis=1))
        elif isinstance(link.joint, Slide):
            slides.append((link.name, hinge))
        elif isinstance(link.joint, Hinges):
            count = len(link.joint.hinges)
            names += [link.name if count == 1 else f"{link.name} {n + 1}" for n in range(count)]
            columns += [ways[:, hinge + n] for n in range(count)]
        hinge += len(axes_of(link.joint))
    turned = np.array(columns).reshape(len(names), len(motion))
    slid = ways[:, [column for _, column in slides]].T
    return Moved(
        tuple(link.name for link in avatar.links), np.sqrt(np.mean(away**2, axis=0)), np.percentile(away, HIGH, axis=0),
        away.max(axis=0), tuple(names), np.sqrt(np.mean(turned**2, axis=1)), np.percentile(turned, HIGH, axis=1),
        tuple(name for name, _ in slides), np.sqrt(np.mean(slid**2, axis=1)), np.percentile(slid, HIGH, axis=1),
    )
