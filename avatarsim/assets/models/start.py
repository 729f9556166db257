"""Start of a model file: its reference, or one of its keyframes."""

from dataclasses import dataclass
from operator import index

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.compiled import Compiled
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

REFERENCE = "qpos0"
"""Name of the reference, for files with keyframes."""


@dataclass(frozen=True, eq=False)
class StartPose:
    """Coordinates of all joints of a file and poses of its mocap bodies, at keyframe `key`, or at the reference for -1."""

    model: Compiled
    key: int

    @property
    def qpos(self) -> Array:
        """Coordinates (n,) in the order of MuJoCo."""
        return self.model.qpos0 if self.key < 0 else self.model.key_qpos[self.key]

    def root(self, body: int) -> tuple[Array, Array]:
        """Return position [m] and orientation of a body of the world, as a free joint or a mocap pose has it."""
        mocap = int(self.model.body_mocapid[body])
        if self.key >= 0 and mocap >= 0:
            place, turn = self.model.key_mpos[self.key].reshape(-1, 3), self.model.key_mquat[self.key].reshape(-1, 4)
            return place[mocap], rotation.normalised(turn[mocap])
        free = np.flatnonzero((self.model.jnt_bodyid == body) & (self.model.jnt_type == 0))
        if self.key < 0 or not len(free):
            return self.model.body_pos[body], rotation.normalised(self.model.body_quat[body])
        first = int(self.model.jnt_qposadr[free[0]])
        return self.qpos[first : first + 3], rotation.normalised(self.qpos[first + 3 : first + 7])

    def notes(self) -> tuple[str, ...]:
        """Return a sentence on the keyframe that is the start."""
        if self.key < 0:
            return ()
        others = len(self.model.key_name) - 1
        more = f" of {others + 1}; keyframe={REFERENCE!r} starts at the reference" if others else ""
        return (f"starts at keyframe {self.model.key_name[self.key] or self.key}{more}",)


def start_pose(model: Compiled, keyframe: str | int | None, file: str) -> StartPose:
    """Return the start: the keyframe of that name or number, by default the one named home, else the first, else the reference.

    Raises UnknownName and InvalidInput for a keyframe that the file does not have.
    """
    names = list(model.key_name)
    if keyframe == REFERENCE or (keyframe is None and not names):
        return StartPose(model, -1)
    if keyframe is None:
        return StartPose(model, names.index("home") if "home" in names else 0)
    if isinstance(keyframe, str) and keyframe and keyframe in names:
        return StartPose(model, names.index(keyframe))
    try:
        number = int(keyframe) if isinstance(keyframe, str) else index(keyframe)
    except ValueError:
        raise UnknownName(f"keyframe of {file}", str(keyframe), [*filter(None, names), REFERENCE]) from None
    except TypeError:
        raise InvalidInput(f"keyframe of {file}", keyframe, "a name or a whole number") from None
    if isinstance(keyframe, bool) or not 0 <= number < len(names):
        valid = f"a name, or a number from 0 to {len(names) - 1}" if names else f"{REFERENCE}, since the file has none"
        raise InvalidInput(f"keyframe of {file}", keyframe, valid)
    return StartPose(model, number)
