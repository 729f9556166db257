"""A filter for streams of generalized coordinates: each output posture is reached from the last one by a motion proved free."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.cleaning.chords import Chords, Room, scene_of
from avatarsim.cleaning.joint_rates import FILE, Rates, accelerations_of, speeds_of
from avatarsim.cleaning.limited import LimitedFollower
from avatarsim.cleaning.result import DEFAULTS, Options
from avatarsim.cleaning.start import approach, free_posture
from avatarsim.cleaning.track import Follower
from avatarsim.errors import InvalidInput
from avatarsim.scene.checks import finite_array, require_near, within
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

FASTEST, SLOWEST = 2000.0, 1.0
"""Largest and smallest rates of a stream [1/s]."""


class Shield:
    """Generalized coordinates in the file's own order in, certified ones out: for teleoperation.

    `model` gives the avatar, its coordinates and bodies, `room` more bodies, or what `load_room` returns or reads; `rate`
    [1/s] is how often the shield is called. Each output is free of overlap and within limits, and so is the motion from the
    last output, as slerp in joints and straight lines for the rest show it. An input that is free itself, and reached by a
    free motion, is returned unchanged, but for quaternions: they are of length 1, and their sign is that nearer to the last
    output. After contact the avatar catches up with the input.

    `speed_limits` and `acceleration_limits` apply in every call, from one output row to the next: a number for all joints,
    numbers by their names or in their order, [rad/s, rad/s^2; of slides and of a root's translation m/s, m/s^2]; of a free joint
    a pair, for its translation and its rotation; None: no limit. Balls and roots are limited in their norm. "file" is the
    `velocity` of a URDF file; files that state none limit nothing. With limits the motion to rest from each output row, all
    joints braking by one factor, is proved free as well, so that the avatar can always stop: `stop` gives it, and a call with
    None continues along it. The first row is shown at rest.

    Raises InvalidInput for a model without avatar, for another rate and for limits that do not fit, UnknownName for names that
    are no joints.

        shield = av.Shield(model, room, rate=50.0, speed_limits="file", acceleration_limits=10.0)
        while robot.is_on():
            robot.move(shield(operator.coordinates()))
    """

    def __init__(
        self, model: Model, room: Room = (), rate: float = 60.0, options: Options = DEFAULTS,
        speed_limits: Rates = FILE, acceleration_limits: Rates = None,
    ) -> None:
        rate = within("rate of a shield [1/s]", rate, SLOWEST, FASTEST, InvalidInput)
        scene = scene_of(model, room, options)
        if model.coordinates is None:
            raise InvalidInput("coordinates of the model", None, "those of an avatar: a file of a robot, a hand or a skeleton")
        self.coordinates, self.options, self._step = model.coordinates, options, 1.0 / rate
        self._chords = Chords(scene)
        speed = speeds_of(speed_limits, self.coordinates, self._chords.world)
        acceleration = accelerations_of(acceleration_limits, self.coordinates, self._chords.world)
        self._limited: LimitedFollower | None = None
        if np.isfinite(speed).any() or np.isfinite(acceleration).any():
            self._limited = LimitedFollower(self._chords, speed, acceleration, self._step, options.margin)
        self._follower: Follower | None = None
        self._before: TrackerSample | None = None
        self._rotations: Array | None = None
        self._time = 0.0
        self.is_free = True

    def __call__(self, q: Array | None) -> Array:
        """Return the nearest free posture to `q` (width,) that is reached by a free motion from the last one.

        `is_free` is True if it is `q` itself. The first one is the nearest that is found free. None: the next posture of the
        motion to rest. Raises InvalidInput for another width, numbers that are not finite, roots farther away than 1e8 m,
        quaternions without length, and None before any posture; and StartOverlaps where no free posture is found near the first
        one; earlier inputs then still count."""
        if q is None:
            return self._without_target()
        row = finite_array("generalized coordinates", q, (self.coordinates.width,), InvalidInput)
        time = self._time + self._step
        sample = self.coordinates.motion(row[None], np.array([time])).sample(0)
        require_near("roots of the posture", sample.positions, InvalidInput)
        if self._follower is None or self._before is None:
            self._follower = self._begun(sample)
        elif self._limited is not None:
            self._limited.follow(sample)
        else:
            self._follower.follow(self._before, sample, self._keeps_margin(sample))
        self._before, self._time = sample, time
        return self._shown(self._limited or self._follower)

    def stop(self) -> Array:
        """Return the postures (n, width) of the proved motion to rest from the last output, one a call.
        Calls with None return them; none at rest, and without limits."""
        found = [self._row(sample) for sample in self._limited.stops()] if self._limited is not None else []
        return np.array(found).reshape(len(found), self.coordinates.width)

    def _without_target(self) -> Array:
        """Return the row of a call without a posture."""
        if self._follower is None:
            raise InvalidInput("generalized coordinates of the first call", None, "an array: where the avatar is")
        self._time += self._step
        if self._limited is not None:
            self._limited.brake(self._time)
        row = self._shown(self._limited or self._follower)
        self.is_free = False
        return row

    def _keeps_margin(self, sample: TrackerSample) -> bool:
        """Return True for a posture that is free and within limits."""
        gap, _ = self._chords.nearest(sample, self.options.margin)
        return gap >= self.options.margin and self._chords.clipped(sample)[1] == (0.0, 0.0)

    def _begun(self, sample: TrackerSample) -> Follower:
        """Return the follower at the first posture."""
        is_free = self._keeps_margin(sample)
        start = sample if is_free else free_posture(self._chords, sample, self.options.margin)
        follower = Follower(self._chords, self.options, start, is_free)
        if self._limited is None:
            follower.load_all()
        if not is_free:
            approach(follower, sample)
        if self._limited is not None:
            self._limited.begin(follower.shown, is_free)
        return follower

    def _shown(self, follower: Follower | LimitedFollower) -> Array:
        """Return the row of the shown posture."""
        self.is_free = follower.is_input
        last = follower.shown.rotations if self._rotations is None else self._rotations
        self._rotations = rotation.continuous(np.stack([last, follower.shown.rotations]))[1]
        return self._row(replace(follower.shown, rotations=self._rotations))

    def _row(self, sample: TrackerSample) -> Array:
        motion = Motion(np.array([sample.time]), sample.positions[None], sample.rotations[None], sample.angles[None])
        return np.asarray(self.coordinates.rows(motion)[0])
