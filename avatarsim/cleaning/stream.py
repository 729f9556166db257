"""A filter for streams of generalized coordinates: each posture that comes out is reached from the last one on a proved free
way."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.cleaning.chords import Chords, scene_of
from avatarsim.cleaning.result import DEFAULTS, Options
from avatarsim.cleaning.start import approach, free_posture
from avatarsim.cleaning.track import Follower
from avatarsim.errors import InvalidInput
from avatarsim.scene.body import Body
from avatarsim.scene.checks import finite_array, require_near, within
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

FASTEST, SLOWEST = 2000.0, 1.0
"""[1/s] rates of a stream."""


class Shield:
    """Generalized coordinates in the file's own order in, certified ones out: for teleoperation.

    `model` gives the avatar, its coordinates and bodies, `room` more bodies; `rate` [1/s] is how often the shield is called.
    What comes out is free of overlap and within limits, and so is the way from the last one that came out, as slerp in joints and
    straight lines for the rest show it. What is free itself, and reached on a free way, comes out as it went in, but for
    quaternions: they are of length 1, and their sign is that nearer to the last ones that came out. After contact the avatar
    catches up with what comes in.

    Raises InvalidInput for a model without avatar and for another rate.

        shield = av.Shield(model, room, rate=50.0)
        while robot.is_on():
            robot.move(shield(operator.coordinates()))
    """

    def __init__(self, model: Model, room: Sequence[Body] = (), rate: float = 60.0, options: Options = DEFAULTS) -> None:
        rate = within("rate of a shield [1/s]", rate, SLOWEST, FASTEST, InvalidInput)
        scene = scene_of(model, room, options)
        if model.coordinates is None:
            raise InvalidInput("coordinates of the model", None, "those of an avatar: a file of a robot, a hand or a skeleton")
        self.coordinates, self.options, self._step = model.coordinates, options, 1.0 / rate
        self._chords = Chords(scene)
        self._follower: Follower | None = None
        self._before: TrackerSample | None = None
        self._rotations: Array | None = None
        self._time = 0.0
        self.is_free = True

    def __call__(self, q: Array) -> Array:
        """The nearest free posture to `q` (width,) that is reached on a free way from the last one; `is_free` says whether that
        is `q` itself. The first one is the nearest that is found free.

        Raises InvalidInput for another width, numbers that are not finite, roots farther away than 1e8 m and quaternions without
        length, and StartOverlaps where no free posture is found near the first one; what came before then still counts."""
        row = finite_array("generalized coordinates", q, (self.coordinates.width,), InvalidInput)
        time = self._time + self._step
        sample = self.coordinates.motion(row[None], np.array([time])).sample(0)
        require_near("roots of the posture", sample.positions, InvalidInput)
        gap, _ = self._chords.nearest(sample, self.options.margin)
        is_free = gap >= self.options.margin and self._chords.clipped(sample)[1] <= 0.0
        if self._follower is None or self._before is None:
            start = sample if is_free else free_posture(self._chords, sample, self.options.margin)
            self._follower = Follower(self._chords, self.options, start, is_free)
            self._follower.load_all()
            if not is_free:
                approach(self._follower, sample)
        else:
            self._follower.follow(self._before, sample, is_free)
        self._before, self._time, self.is_free = sample, time, self._follower.is_input
        shown = self._follower.shown
        last = sample.rotations if self._rotations is None else self._rotations
        self._rotations = rotation.continuous(np.stack([last, shown.rotations]))[1]
        motion = Motion(np.array([time]), shown.positions[None], self._rotations[None], shown.angles[None])
        return np.asarray(self.coordinates.rows(motion)[0])
