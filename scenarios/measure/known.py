"""Shared by all measures of one scene, whichever engine was recorded: the judge, free targets, frames in contact."""

import hashlib
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from scenarios.measure.posture.free import free_frames, raw_states
from scenarios.measure.posture.smoothness import NEAR
from scenarios.scenario import Scenario

if TYPE_CHECKING:
    from reference.judging.judge import Judge

Flags = NDArray[np.bool_]


class Known:
    """The judge of one scene, and the frames in which the way is free: where nothing but the user moves, these are the same for
    all engines, and measuring them takes a quarter of the judge's time."""

    def __init__(self, scenario: Scenario, scene: Scene) -> None:
        self.scenario, self.scene = scenario, scene
        self._free: tuple[bytes, Flags] | None = None

    @cached_property
    def judge(self) -> "Judge":
        """Judge of the scene. Raises ImportError where its package is missing: a compiled one that not every machine has."""
        from reference.judging.judge import Judge

        return Judge(self.scene)

    def free(self, recording: Recording) -> Flags:
        """Return (F+1,) True where the raw posture is one that could be shown; computed once for the same bits."""
        digest = _digest(*raw_states(recording), recording.raw_orientations, recording.raw_angles)
        if self._free is None or self._free[0] != digest:
            self._free = digest, free_frames(recording, self.scenario, self.scene, self.judge.link_depths)
        return self._free[1]

    def contact(self, recording: Recording) -> Flags:
        """Return (F+1,) True where something holds the avatar back or could: the raw posture is not free, or a link as it is
        shown has a gap of at most NEAR to a body that it may not overlap. From poses alone, so the same for all engines."""
        contact = ~self.free(recording)
        # where the target already decides, the judge is not needed
        unknown = ~contact
        if self.scene.links and unknown.any():
            gaps = self.judge.link_gaps(recording.positions[unknown], recording.orientations[unknown], NEAR)
            contact[unknown] = ~(gaps > NEAR)
        return contact


def _digest(*arrays: NDArray[np.float64]) -> bytes:
    """Return the digest of the bits and shapes of arrays."""
    digest = hashlib.blake2b()
    for array in arrays:
        digest.update(repr(array.shape).encode() + np.ascontiguousarray(array).tobytes())
    return digest.digest()
