"""A tracker's stream of postures at one step per rendered frame, cut, mirrored and led in as a scene needs it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.motions.deepmimic import Clip
from avatarsim.errors import InvalidInput
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Ball, Free, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.motion.mocap import retimed
from scenarios.scenario import RENDERED, Motion

Array = NDArray[np.float64]

LEAD_IN = 30
"""Frames in which the tracker walks from a scene's start posture to the first pose of its clip: half a second,
brisk for a user but no teleport."""


@dataclass(frozen=True, eq=False)
class Track:
    """F postures of the avatars of a scene: positions (F, links, 3), rotations (F, links, 4), angles (F, hinges)."""

    positions: Array
    rotations: Array
    angles: Array

    def __len__(self) -> int:
        return len(self.positions)

    def posture(self, frame: int) -> TrackerSample:
        """Return the posture of the user at the end of `frame`; past the last frame the user keeps still."""
        if frame < 0:
            raise InvalidInput("frame of a track", frame, "0 and up")
        k = min(frame, len(self) - 1)
        return TrackerSample((frame + 1) * RENDERED, self.positions[k], self.rotations[k], self.angles[k])

    def motion(self) -> Motion:
        """Return the track as a scenario's motion."""
        return self.posture

    def backwards(self) -> "Track":
        """Return the same postures, the last one first."""
        return Track(self.positions[::-1], self.rotations[::-1], self.angles[::-1])

    def there_and_back(self, frames: int) -> "Track":
        """Return `frames` postures: the track forwards, backwards, forwards, ... without standing still at the turns."""
        turn = max(len(self) - 1, 1)
        phase = np.arange(frames) % (2 * turn)
        order = np.minimum(phase, 2 * turn - phase)
        return Track(self.positions[order], self.rotations[order], self.angles[order])

    def led_in(self, start: TrackerSample, frames: int = LEAD_IN) -> "Track":
        """Return the same track after `frames` postures that lead from `start`, itself not among them, to its first one."""
        # smooth at both ends: a constant rate would start and stop with a jerk that no user makes
        u = np.arange(1, frames + 1) / (frames + 1)
        eased = u * u * (3.0 - 2.0 * u)
        line = eased[:, None, None]
        return Track(
            np.concatenate([start.positions + line * (self.positions[0] - start.positions), self.positions]),
            np.concatenate([
                rotation.slerp(start.rotations[None], self.rotations[:1], np.tile(eased[:, None], len(start.rotations))),
                self.rotations,
            ]),
            np.concatenate([start.angles + eased[:, None] * (self.angles[0] - start.angles), self.angles]),
        )


def to_and_fro(clip: Clip, scene: Scene, frames: int) -> Motion:
    """Return half a second from the scene's start into the clip's first posture, then the clip, back and forth: `frames`."""
    track = track_of(retimed(clip), scene.avatars[0])
    return track.there_and_back(frames - LEAD_IN).led_in(scene.first_sample).motion()


def track_of(clip: Clip, avatar: Avatar) -> Track:
    """Return the clip's postures for `avatar`; joints that the clip does not know stay at zero."""
    frames = len(clip.times)
    positions = np.zeros((frames, len(avatar.links), 3))
    rotations = np.tile(rotation.IDENTITY, (frames, len(avatar.links), 1))
    angles: list[Array] = []
    for k, link in enumerate(avatar.links):
        if isinstance(link.joint, Free):
            positions[:, k] = clip.root_positions
        if isinstance(link.joint, (Free, Ball)) and link.name in clip.rotations:
            rotations[:, k] = clip.rotations[link.name]
        if isinstance(link.joint, Hinges):
            recorded = clip.angles.get(link.name, np.zeros(frames))
            angles += [recorded, *(np.zeros(frames) for _ in link.joint.hinges[1:])]
    return Track(positions, rotations, np.array(angles).reshape(-1, frames).T.copy())
