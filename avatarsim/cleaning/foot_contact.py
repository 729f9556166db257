"""Support phases of feet, and how far planted feet slide.

A foot is one of the last two links of a limb, so that hands and knees of a crawl count as well. Between two frames it is planted
if its sole is near the room at both ends and the lowest point of the sole hardly moves: thresholds of height and speed, as Kovar,
Schreiner and Gleicher (2002) find the constraints of footskate cleanup. Only the two frames decide on it, so the answer is the
same wherever a clip is cut.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.cleaning.chords import Chords
from avatarsim.model.geometry import ELLIPSOID, piece_points
from avatarsim.scene.body import Role
from avatarsim.scene.carried import of_avatar
from avatarsim.scene.motion import Motion
from avatarsim.scene.shape import Piece
from avatarsim.scene.tracker import TrackerSample, poses_of_links
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

PLANTED_HEIGHT = 0.03
"""[m] above the room up to which a sole may be planted: the error of the ground of recordings. Larger: feet that pass low over
the ground are held to it where they turn slowly; smaller: planted feet of recordings that float are missed."""

PLANTED_SPEED = 0.3
"""[m/s] of a sole's lowest point up to which a foot is planted: a foot in swing passes at more than 1 m/s, and recorded soles
creep by 0.1. Larger: steps that scuff count as planted; smaller: feet that the recording itself lets slide do not."""


@dataclass(frozen=True, eq=False)
class Soles:
    """Feet of an avatar: numbers of their links, and the points (p, 3) [m] and the radii (p,) [m] of the pieces of each."""

    links: tuple[int, ...]
    points: tuple[Array, ...]
    radii: tuple[Array, ...]

    def lowest(self, positions: Array, rotations: Array) -> tuple[Array, Array]:
        """Return the lowest material point of each foot in each frame, for poses (F, links, 3) and (F, links, 4).
        It is given in its link and in the world, (F, feet, 3) each."""
        inside, world = np.zeros((2, len(positions), len(self.links), 3))
        frames = np.arange(len(positions))
        for n, (link, points, radii) in enumerate(zip(self.links, self.points, self.radii, strict=True)):
            turned = rotation.to_matrix(rotations[:, link])
            at = np.argmin(points @ turned[:, 2, :].T - radii[:, None], axis=0)
            inside[:, n] = points[at] - radii[at, None] * turned[:, 2, :]
            world[:, n] = positions[:, link] + np.einsum("fij,fj->fi", turned, inside[frames, n])
        return inside, world


def soles(chords: Chords) -> Soles:
    """Return the feet of the cleaned avatar."""
    avatar = chords.scene.avatars[0]
    parents = {link.parent for link in avatar.links}
    carriers = {link.parent for link in avatar.links if link.name in parents}
    feet = [(k, *_points(link.pieces)) for k, link in enumerate(avatar.links)
            if link.pieces and link.parent is not None and link.name not in carriers]
    return Soles(*zip(*feet, strict=True)) if feet else Soles((), (), ())


def _points(pieces: tuple[Piece, ...]) -> tuple[Array, Array]:
    """Return the points (p, 3) [m] and the radii (p,) [m] whose hull the pieces are; ends of the axes of an ellipsoid."""
    points, radii = [], []
    for piece in pieces:
        kind, rows, radius = piece_points(piece)
        rows = rows[0] + np.concatenate([rows[1:], -rows[1:]]) if kind == ELLIPSOID else rows
        points.append(rows)
        radii.append(np.full(len(rows), radius))
    return np.concatenate(points), np.concatenate(radii)


def slip_speeds(chords: Chords, motion: Motion) -> Array:
    """Return the level speed (F-1, feet) [m/s] of the lowest point of each sole from each frame to the next.
    It is that of a point of the link: a foot that rolls from heel to toe does not slip."""
    avatar, feet = chords.scene.avatars[0], soles(chords)
    own = of_avatar(motion, avatar)
    positions, rotations = poses_of_links((avatar,), own.positions, own.rotations, own.angles)
    inside, world = feet.lowest(positions, rotations)
    links = list(feet.links)
    after = positions[1:, links] + rotation.rotate(rotations[1:, links], inside[:-1])
    level = np.linalg.norm((after - world[:-1])[..., :2], axis=2)
    return np.asarray(level / np.diff(motion.times)[:, None])


def lowered_gaps(chords: Chords, motion: Motion, links: Sequence[int], heights: float | Array) -> Array:
    """Return the signed distance (F, links) [m] of links from the fixed bodies with the avatar lowered by heights (F,) [m].
    It is some number above 0 for links that are apart from them then."""
    bodies = len(chords.scene.bodies)
    fixed = [k for k, body in enumerate(chords.scene.bodies) if body.role is Role.FIXED]
    pairs = np.array([(body, bodies + link) for link in links for body in fixed], dtype=np.int64).reshape(-1, 2)
    found = np.full((len(motion), len(links)), np.inf)
    if not len(pairs):
        return found
    lowered = np.broadcast_to(heights, len(motion))
    for frame in range(len(motion)):
        sample = motion.sample(frame)
        positions = sample.positions.copy()
        positions[chords.free_roots, 2] -= lowered[frame]
        gaps = chords.gaps(TrackerSample(sample.time, positions, sample.rotations, sample.angles), pairs)
        found[frame] = gaps.reshape(len(links), len(fixed)).min(axis=1)
    return found


def planted_feet(chords: Chords, motion: Motion) -> Flags:
    """Return between which frames (F-1, feet) each foot is planted on the room."""
    near = lowered_gaps(chords, motion, soles(chords).links, PLANTED_HEIGHT) <= 0.0
    return np.asarray(near[:-1] & near[1:] & (slip_speeds(chords, motion) <= PLANTED_SPEED))


def foot_slide(chords: Chords, motion: Motion, planted: Flags) -> float:
    """Return the mean speed [m/s] of soles in the steps (F-1, feet) in which they should be planted; nan without any."""
    return float(slip_speeds(chords, motion)[planted].mean()) if planted.any() else float("nan")
