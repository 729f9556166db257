"""Kinematics, joint limits and goals of avatars alone in the world, by the engine's kernels."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.goals import make_goal_scratch
from avatarsim.ik.make import empty_posture, spans
from avatarsim.ik.state import TRACKING, Rig, Tracking
from avatarsim.ik.target import clip_to_limits
from avatarsim.model.conversion import read_sample, write_sample, write_shown
from avatarsim.model.geometry import geometry
from avatarsim.model.skeleton import Posture, carry, hinge_dofs, skeleton
from avatarsim.model.world import sample_arrays
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample

Array = NDArray[np.float64]

MATERIAL = "human"
"""A material that every scene has."""


class BareAvatars:
    """Avatars without shapes in an empty scene, and room for a posture; each method overwrites what it returned before."""

    def __init__(self, avatars: Sequence[Avatar]) -> None:
        bare = [replace(one, links=tuple(replace(link, pieces=(), material=MATERIAL) for link in one.links)) for one in avatars]
        scene = Scene("bare", (), tuple(bare))
        self.skeleton = skeleton(scene)
        self.hinges, self._rig = hinge_dofs(self.skeleton), Rig(geometry(scene), self.skeleton, spans(self.skeleton))
        links, degrees = len(self.skeleton.kind), int(self.skeleton.first_dof[-1])
        self._posture, self._clipped = empty_posture(links, degrees), empty_posture(links, degrees)
        self._tracking = np.zeros(len(self._rig.avatars.first_link) - 1, TRACKING).view(Tracking)
        self._scratch, self._centres = make_goal_scratch(self.skeleton, 0), np.zeros((links, 3))
        self._places, self._turns, self._angles = np.zeros((links, 3)), np.zeros((links, 4)), np.zeros(len(self.hinges))

    def read(self, sample: TrackerSample) -> Posture:
        """Return a sample, which has been checked, as arrays."""
        read_sample(*sample_arrays(sample), self.hinges, self._posture)
        return self._posture

    def sample(self, posture: Posture, time: float = 0.0) -> TrackerSample:
        """Return a posture as a sample at `time` [s]."""
        write_sample(posture, self.hinges, self._places, self._turns, self._angles)
        return TrackerSample(time, self._places, self._turns, self._angles)

    def clipped(self, posture: Posture) -> Posture:
        """Return the posture with each joint at the nearest place inside its limits."""
        clip_to_limits(self._rig, posture, self._tracking, self._clipped)
        return self._clipped

    def poses(self, posture: Posture) -> tuple[Array, Array]:
        """Return the places (links, 3) [m] and orientations (links, 4) of the links in the world."""
        carry(self.skeleton, posture, self._scratch.still, self._scratch.poses, self._scratch.axes)
        poses = self._scratch.poses
        write_shown(poses.position, poses.rotation, self._centres, 0, self._places, self._turns)
        return self._places, self._turns
