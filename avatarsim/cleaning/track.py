"""Tracking with hold-back: the engine follows a motion in sub-steps, and only postures reached by a proved motion are written.

The engine certifies its own steps along straight lines of vertices; a player shows slerp in joints. So each written posture is
reached from the one before by a motion segment that `Chords` has proved (adaptive step size control: the largest of the sub-steps
that holds, else a part of the first). A frame of the input that is free itself, and to which the motion is free, is written
unchanged.

Carried bodies are fixed ones to the engine, advanced in steps so small that no gap is used up in one; the bodies that they push
give way between. The motion from frame to frame is proved with both in motion.
"""

from dataclasses import dataclass, replace
from enum import IntEnum
from math import ceil

import numpy as np
from numpy.typing import NDArray

from avatarsim.cleaning.chords import Chords, Pair, between, difference
from avatarsim.cleaning.result import Options
from avatarsim.cleaning.start import free_posture
from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError, StartOverlaps
from avatarsim.model.geometry import piece_points
from avatarsim.scene.body import fixed
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Ellipsoid, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

SUB_STEPS = 120.0
"""[1/s] least rate of sub-steps of the engine. Fewer: longer steps, which more often come too near the centre that a limb turns
around."""

ARRIVED = 1e-9
"""[m, rad] an engine's posture so near the input's is the input's, but for rounding."""

SPARED = 0.9
"""Share taken of a motion segment that ends at an obstacle: at its very end the next one could not begin."""

GROWTH, LEVELS = 3.0, 4
"""Factor from one gap to the next that is tried where a motion is not free, and how many are tried, including the margin: a fast
foot dips between two frames by up to some centimetres, and has to pass higher. Fewer: it waits instead, and jumps once it is
released."""

PUSHED, FINEST = 0.2, 256
"""Largest motion of a carried body between two sub-steps, in gaps that are kept, and most sub-steps of a frame. The engine
accepts a quarter of the gap (tolerances.LEAST_SHARE): more than that in one step could pass it. More sub-steps: faster bodies
push others, and frames take longer; fewer: they leave no proved motion, and the frame is flagged."""

PARTS = (0.5, 0.25, 0.0)
"""Shares of the first sub-step that are tried where a carried body has moved on and its whole is not reached."""

CATCH_UP = {"catch_up_turn": 6.25, "catch_up_move": 2.5, "natural_frequency": 1000.0}
"""[rad/s, m/s, rad/s] speeds at which a limb held off returns: half of the engine's live speeds, where a user waits for it, since
a limb that snaps back is visible in a clip. Hardly any inertia, since blends replace it: with 100 rad/s jerk is equal, and three
times as many free frames differ from the input."""


class Kind(IntEnum):
    """Origin of a written frame."""

    INPUT = 0
    """The input's, bit for bit."""
    TRACKED = 1
    """The engine's posture for the frame."""
    HELD = 2
    """An earlier posture on the way to the tracked one, since the rest of the motion was not proved free."""
    BLENDED = 3
    """The posture for a target that gives way before or after contact."""
    CROSSED = 4
    """A free posture to which no motion was proved, since a carried body came into the last one."""


class Judged:
    """Properties of single postures of a motion: gap (F,) smallest signed distance [m], above `margin` where nothing is as near;
    pair of each; beyond (F, 2) excess over limits of joints [rad] and slides [m]; is_free (F,)."""

    def __init__(self, chords: Chords, motion: Motion, margin: float) -> None:
        frames, self.margin = len(motion), margin
        self.gap, self.beyond = np.full(frames, np.inf), np.zeros((frames, 2))
        self.pair: list[Pair | None] = [None] * frames
        for k in range(frames):
            sample = motion.sample(k)
            self.gap[k], self.pair[k] = chords.nearest(sample, margin)
            self.beyond[k] = chords.clipped(sample)[1]
        self.is_free: NDArray[np.bool_] = (self.gap >= margin) & (self.beyond <= 0.0).all(axis=1)


@dataclass(frozen=True, eq=False)
class LinkWeights:
    """Weights (F, links) of link origins in the objective at times (F,) [s] of a motion."""

    times: Array
    rows: Array

    def at(self, time: float) -> Array:
        """Return the weights (links,) of the frame at or after a time."""
        return np.asarray(self.rows[min(int(np.searchsorted(self.times, time - 1e-9)), len(self.rows) - 1)])


class Follower:
    """The avatar as it follows postures: `shown` is the last written posture, `is_input` whether it equals the input.
    `weights` are those of links in the objective, by time; None: all are equal."""

    def __init__(
        self, chords: Chords, options: Options, start: TrackerSample, is_input: bool, weights: LinkWeights | None = None
    ) -> None:
        self.chords, self.options, self._weights = chords, options, weights
        self.shown, self.is_input = start, is_input
        self._engines: dict[int, AvatarsimEngine] = {}
        self._avatar, self._carried = chords.scene.avatars[0], chords.scene.avatars[1:]
        self._reach = [max((norm_of(piece) for piece in one.links[0].pieces), default=0.0) for one in self._carried]
        self._level, self._since, self._at = 0, 0.0, -1

    def load_all(self) -> None:
        """Load the engines of all levels now; otherwise each is loaded at its first use, which takes milliseconds."""
        for level in range(LEVELS):
            self._engine(level, self.shown)

    def begin(self, start: TrackerSample, is_input: bool) -> None:
        """Restart at another posture."""
        self.shown, self.is_input = start, is_input
        self._level, self._at = 0, -1

    def follow(self, before: TrackerSample, after: TrackerSample, is_free: bool) -> Kind:
        """Advance to `after`, coming from `before`, which the input shows at their times, and store the result in `shown`.
        `is_free`: whether the input is free there."""
        if self.is_input and is_free and self._reaches(after):
            self.shown, self._at = after, -1
            return Kind.INPUT
        self.is_input = False
        duration = abs(after.time - before.time)
        self._since += duration
        if self._since > self.options.blend and self._level > 0:
            self._level, self._since = self._level - 1, 0.0
        tried: list[TrackerSample] = []
        for level in range(self._level, LEVELS):
            tried = self._steps(level, before, after, duration)
            if not tried:
                continue
            if is_free and difference(self.chords, tried[-1], after) < ARRIVED and self._reaches(after):
                self.shown, self.is_input, self._level, self._at = after, True, 0, -1
                return Kind.INPUT
            if self._reaches(tried[-1]):
                if level > self._level:
                    self._level, self._since = level, 0.0
                self.shown = tried[-1]
                return Kind.TRACKED
        return self._write_partial_motion(tried, after)

    def _engine(self, level: int, user: TrackerSample) -> AvatarsimEngine:
        """Return the engine that keeps the gap of a level, with the avatar at its shown posture and the user at `user`."""
        if level not in self._engines:
            self._engines[level] = AvatarsimEngine()
            options = {"stand_off": self.options.margin * GROWTH**level, "around": 0, **CATCH_UP}
            settings = Settings(options=options, seed=self.options.seed, start="exact")
            self._engines[level].load(self._scene(), settings, 1.0 / SUB_STEPS)
        if self._at != level:
            self._put(self._engines[level], self.shown, user)
        self._at = level
        return self._engines[level]

    def _scene(self) -> Scene:
        """Return the scene for an engine: carried bodies are fixed where they are shown."""
        scene = self.chords.scene
        if not self._carried:
            return replace(scene, start=self.shown)
        poses = self._poses(self.shown)
        bodies = [fixed(one.name, one.links[0].pieces, one.links[0].material, *poses[one.name]) for one in self._carried]
        return replace(scene, bodies=(*scene.bodies, *bodies), avatars=(self._avatar,), start=self._own(self.shown))

    def _own(self, sample: TrackerSample) -> TrackerSample:
        """Return the avatar's part of a posture."""
        if not self._carried:
            return sample
        links, hinges = len(self._avatar.links), self._avatar.hinge_count
        return TrackerSample(sample.time, sample.positions[:links], sample.rotations[:links], sample.angles[:hinges])

    def _with_carried(self, own: TrackerSample, other: TrackerSample) -> TrackerSample:
        """Return a posture of the avatar, with carried bodies at their poses in `other`."""
        if not self._carried:
            return own
        links = len(self._avatar.links)
        positions = np.concatenate([own.positions, other.positions[links:]])
        return TrackerSample(own.time, positions, np.concatenate([own.rotations, other.rotations[links:]]), own.angles)

    def _poses(self, sample: TrackerSample) -> dict[str, tuple[Vector, Quaternion]]:
        """Return poses of carried bodies, by name."""
        links = enumerate(self._carried, len(self._avatar.links))
        return {one.name: (tuple(sample.positions[k].tolist()), tuple(sample.rotations[k].tolist())) for k, one in links}

    def _put(self, engine: AvatarsimEngine, sample: TrackerSample, user: TrackerSample) -> None:
        """Put the avatar and carried bodies at `sample`, and the user at `user`."""
        engine.put(self._own(sample), self._own(user), self._poses(sample))

    def _count(self, level: int, before: TrackerSample, after: TrackerSample, duration: float) -> int:
        """Return the number of sub-steps between two postures."""
        count = max(1, ceil(duration * SUB_STEPS - 1e-6))
        for k, reach in enumerate(self._reach, len(self._avatar.links)):
            turn = rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(before.rotations[k]), after.rotations[k]))
            way = float(np.linalg.norm(after.positions[k] - before.positions[k]) + np.linalg.norm(turn) * reach)
            count = max(count, min(FINEST, ceil(way / (PUSHED * self.options.margin * GROWTH**level))))
        return count

    def _steps(self, level: int, before: TrackerSample, after: TrackerSample, duration: float) -> list[TrackerSample]:
        """Return the engine's sub-states on the way; none where a carried body cannot advance without an overlap."""
        tried: list[TrackerSample] = []
        try:
            engine, count = self._engine(level, before), self._count(level, before, after, duration)
            for k in range(1, count + 1):
                user = after if k == count else between(before, after, k / count)
                if self._carried:
                    engine.place(self._poses(user))
                if self._weights is not None:
                    engine.weigh_links(self._weights.at(user.time))
                engine.advance(self._own(user), duration / count)
                tried.append(self._with_carried(engine.posture(), after))
        except StartOverlaps:
            self._at = -1
            return []
        return tried

    def _reaches(self, sample: TrackerSample) -> bool:
        return self.chords.free_until(self.shown, sample)[0] >= 1.0

    def _write_partial_motion(self, tried: list[TrackerSample], user: TrackerSample) -> Kind:
        """Write the last of the engine's sub-states that is reached by a free motion, or a part of the motion to the first."""
        if self._carried:
            return self._give_way(tried, user)
        engine = self._engines[self._at]
        for sample in tried[-2::-1]:
            if self._reaches(sample):
                engine.put(sample, user)
                self.shown = sample
                return Kind.HELD
        share, _ = self.chords.free_until(self.shown, tried[0])
        part, _ = self.chords.clipped(between(self.shown, tried[0], SPARED * share))
        try:
            if self._reaches(part):
                engine.put(part, user)
                self.shown = part
                return Kind.HELD
        except AvatarsimError:
            # a ball may pass beyond its limits between two postures within them
            pass
        engine.put(self.shown, user)
        return Kind.HELD

    def _give_way(self, tried: list[TrackerSample], user: TrackerSample) -> Kind:
        """Hold back where carried bodies have moved on, so that the last posture may no longer be free.
        In that case a free posture is written without a proved motion to it."""
        self._at, shown = -1, self._with_carried(self._own(self.shown), user)
        parts = [self.chords.clipped(between(shown, one, share))[0] for one in (tried[0] if tried else shown,) for share in PARTS]
        for sample in (*tried[-2::-1], *parts):
            if self._reaches(sample):
                self.shown = sample
                return Kind.HELD
        free = (one for one in (*tried[-1:], shown) if self.chords.nearest(one, 0.0)[0] > 0.0)
        self.shown = next(free, None) or free_posture(self.chords, user, self.options.margin)
        return Kind.CROSSED


def norm_of(piece: Piece) -> float:
    """Return the largest distance [m] of a piece's points from the origin of its body."""
    _, points, radius = piece_points(piece)
    lengths = np.linalg.norm(points, axis=1)
    return radius + float(lengths.sum() if isinstance(piece.shape, Ellipsoid) else lengths.max())


class Written:
    """A written motion: arrays as in Motion, and a Kind per frame."""

    def __init__(self, motion: Motion) -> None:
        self.times = motion.times
        self.positions, self.rotations, self.angles = motion.positions.copy(), motion.rotations.copy(), motion.angles.copy()
        self.kind = np.zeros(len(motion), dtype=np.int64)

    def put(self, frame: int, sample: TrackerSample, kind: Kind) -> None:
        """Write a frame; an input frame is there already."""
        self.kind[frame] = kind
        if kind is not Kind.INPUT:
            self.positions[frame], self.rotations[frame], self.angles[frame] = sample.positions, sample.rotations, sample.angles

    def copy_frames(self, other: "Written", first: int, last: int) -> None:
        """Copy frames first .. last from another one."""
        some = slice(first, last + 1)
        for target, source in (
            (self.positions, other.positions), (self.rotations, other.rotations), (self.angles, other.angles),
            (self.kind, other.kind),
        ):
            target[some] = source[some]

    @property
    def motion(self) -> Motion:
        """Return the written frames as a motion."""
        return Motion(self.times, self.positions, self.rotations, self.angles)


def track(
    follower: Follower, motion: Motion, is_free: NDArray[np.bool_], frames: range, written: Written
) -> None:
    """Follow the motion through `frames`, in either direction, from the first of them, where the follower is."""
    for before, after in zip(frames, frames[1:], strict=False):
        kind = follower.follow(motion.sample(before), motion.sample(after), bool(is_free[after]))
        written.put(after, follower.shown, kind)
