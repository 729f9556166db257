"""Scenes from a user's files in the catalogue: MJCF, URDF and meshes, driven by a recorded motion or left to gravity; recordings
of `avatarsim live`, with what was driven.

Each process of a run reads the files again, so what is asked for travels in the environment, which every process inherits.
"""

import json
import os
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property, lru_cache, partial, reduce
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from avatarsim.assets.models.model import Model, beside, followed_by
from avatarsim.engine import Settings
from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.scene.checks import within
from avatarsim.scene.motion import Motion as Recording
from avatarsim.scene.scene import Scene
from runfiles.naming import GATED, OWN_PREFIX
from scenarios.building.promises import FINITE, NO_OVERLAP, WITHIN_LIMITS
from scenarios.engines import opened
from scenarios.motion.track import Track
from scenarios.scenario import RENDERED, Motion, Scenario

VARIABLE = "AVATARSIM_OWN_SCENES"
"""Environment variable that holds what was asked for, as JSON; empty or absent without own scenes."""
QUICK = 600
"""Frames of a quick comparison at most, ten seconds: three engines with some thirty settings take a minute for them."""
LONGEST = 3600.0
"""[s] of a scene at most, an hour; longer ones are not kept in memory."""
MODELS = (".xml", ".mjcf", ".urdf")
"""Endings of files that may hold joints."""
DRIVEN = ".live"
"""Ending of recordings of `avatarsim live`: scene and samples in one file."""
MARGIN = 1e-3
"""[m] the first posture is looked for with so much room about it, as in cleaning."""


if TYPE_CHECKING:
    from avatarsim.assets.motions.motion_file import MotionFile


@dataclass(frozen=True)
class OwnScene:
    """A scene as its user asks for it: `file` with whatever is in it, an `avatar` beside it, a `room`, a `motion`; empty words
    for what is not there. `seconds` how long it runs without a motion, at most how long with one; `scene_scale`, `avatar_scale`
    and `room_scale` are metres a unit of length of the file, the avatar's and the room's."""

    name: str
    file: str
    avatar: str = ""
    room: str = ""
    motion: str = ""
    seconds: float = 5.0
    scene_scale: float = 1.0
    avatar_scale: float = 1.0
    room_scale: float = 1.0

    @cached_property
    def recorded(self) -> "MotionFile | None":
        """The motion file; None without one. Raises InvalidFile for what cannot be read."""
        from avatarsim.assets.motions.load import load_motion

        return load_motion(self.motion) if self.motion else None

    @property
    def is_recording(self) -> bool:
        """Whether the file is a recording of `avatarsim live`."""
        return Path(self.file).suffix.lower() == DRIVEN

    @cached_property
    def models(self) -> tuple[Model, ...]:
        """What has the avatar, if anything has, then what stands about it. Raises InvalidFile for what cannot be read."""
        from avatarsim.assets.models.load import load_avatar, load_room

        rooms = [load_room(self.room, scale=self.room_scale)] if self.room else []
        as_room = partial(load_room, self.file, scale=self.scene_scale)
        if self.avatar:
            return load_avatar(self.avatar, scale=self.avatar_scale), as_room(), *rooms
        has_joints = Path(self.file).suffix.lower() in MODELS
        found = load_avatar(self.file, scale=self.scene_scale) if has_joints else as_room()
        if found.avatar is not None and len(found.avatar.links) > 1:
            return found, *rooms
        brought = None if self.recorded is None else self.recorded.model()
        if brought is not None:
            # a recording on its own skeleton
            return brought, as_room(), *rooms
        # a loose body is an avatar only where a motion drives it
        return (found if self.motion else as_room()), *rooms

    @property
    def said(self) -> tuple[str, ...]:
        """What readers say: units guessed, bodies raised, pairs left out of contact since they overlap in the file."""
        if self.is_recording:
            return ()
        heard = [*(() if self.recorded is None else self.recorded.said), *(said for model in self.models for said in model.said)]
        return tuple(dict.fromkeys(heard))

    def replayed(self) -> tuple[Scene, Track]:
        """Scene and samples of a recording of `avatarsim live`; what was ordered in between, switches among it, is left out.

        Raises InvalidFile for what is no recording, or beside which an avatar, a room, a motion or a scale is named."""
        from avatarsim.live.recording import Frame, read

        scale = "" if self.scene_scale == 1.0 else f"{self.scene_scale:g}"
        beside = (("--avatar", self.avatar), ("--room", self.room), ("--motion", self.motion), ("--scene-scale", scale))
        for name, other in beside:
            if other:
                raise InvalidFile(f"{name} beside {Path(self.file).name}", other, "nothing: a recording has all of it")
        found = read(Path(self.file))
        samples = [row.sample for row in found.rows if isinstance(row, Frame)]
        if not samples or not found.plan.scene.avatars:
            raise InvalidFile(f"frames of {Path(self.file).name}", len(samples), "1 at least, of a scene with an avatar")
        times = np.arange(len(samples), dtype=np.float64) / found.plan.rate
        driven = Recording(
            times, np.array([one.positions for one in samples]), np.array([one.rotations for one in samples]),
            np.array([one.angles for one in samples], dtype=np.float64),
        ).resampled(1.0 / RENDERED)
        return replace(found.plan.scene, name=self.name), Track(driven.positions, driven.rotations, driven.angles)

    def parts(self) -> tuple[Scene, Track | None]:
        """The scene with a first posture that is free, and the motion from there; None without one."""
        if self.is_recording:
            return self.replayed()
        # here and not above: to list the catalogue needs no compiler
        from avatarsim.cleaning.chords import Chords
        from avatarsim.cleaning.start import free_posture

        model, *rooms = self.models
        together = reduce(beside, rooms, model)
        scene = together.scene(self.name)
        if model.avatar is None:
            if self.motion:
                raise InvalidFile(f"avatar in {Path(self.file).name}", "none", "a file with joints, which --motion drives")
            return scene, None
        chords = Chords(scene)
        if self.recorded is None:
            return replace(scene, start=free_posture(chords, scene.first_sample, MARGIN)), None
        recorded = followed_by(self.recorded.motion(model), together.moving).resampled(1.0 / RENDERED)
        start = free_posture(chords, recorded.sample(0), MARGIN)
        track = Track(recorded.positions, recorded.rotations, recorded.angles).led_in(start)
        return replace(scene, start=start), track

    def scenario(self) -> Scenario:
        """The question that is put to every engine: nothing overlaps, limits hold, all is finite; the rest is measured."""
        frames = max(1, round(self.seconds / RENDERED))
        if self.motion or self.is_recording:
            track = _parts(self)[1]
            frames = min(frames, len(track)) if track is not None else frames

        def motion(scene: Scene, seed: int) -> Motion:
            track = _parts(self)[1]
            return held(scene) if track is None else track.motion()

        kept = (NO_OVERLAP, FINITE, WITHIN_LIMITS) if _parts(self)[0].derived_effects.limits else (NO_OVERLAP, FINITE)
        what = " with ".join(filter(None, (Path(self.file).name, Path(self.motion).name if self.motion else "")))
        return Scenario(
            name=self.name, title=f"A user's own scene: {what}.",
            judged="Overlap, numbers and limits, as promised; all else is measured without a bound.",
            build=lambda: _parts(self)[0], motion=motion, frames=frames, short=min(frames, QUICK), bounds=kept,
            everyday=True, family=self.name,
        )


def held(scene: Scene) -> Motion:
    """A user that stays as the scene begins."""
    return lambda frame: replace(scene.first_sample, time=(frame + 1) * RENDERED)


@lru_cache(maxsize=8)
def _parts(own: OwnScene) -> tuple[Scene, Track | None]:
    return own.parts()


def named(file: str, taken: Sequence[str]) -> str:
    """A scene's name from its file's: letters, digits and underscores, one that is not `taken`."""
    plain = OWN_PREFIX + (re.sub(r"[^a-z0-9]+", "_", Path(file).stem.lower()).strip("_")[:40] or "scene")
    number = next(k for k in range(1, len(taken) + 2) if (plain if k == 1 else f"{plain}_{k}") not in taken)
    return plain if number == 1 else f"{plain}_{number}"


def ask(
    files: Sequence[str], avatar: str | None, room: str | None, motion: str | None, seconds: float, *,
    scene_scale: float = 1.0, avatar_scale: float = 1.0, room_scale: float = 1.0,
) -> list[str]:
    """Take these files as the scenes of this process and of those that it starts, once each is read and its start is free. Scales
    are metres a unit of length of the files of scenes, avatar and room.

    Returns what readers say of each: units guessed, bodies raised and pairs left out of contact since they overlap in the file.

    Raises InvalidFile for what cannot be read, InvalidInput for a duration without sense, StartOverlaps where bodies overlap."""
    within("--seconds [s]", seconds, RENDERED, LONGEST, InvalidInput)
    found: list[OwnScene] = []
    for file in files:
        own = OwnScene(
            named(file, [one.name for one in found]), whole(file), whole(avatar), room if room == "floor" else whole(room),
            whole(motion), seconds, scene_scale, avatar_scale, room_scale,
        )
        scene, _ = _parts(own)
        engine = opened(GATED[0])
        try:
            engine.load(scene, Settings(), RENDERED)
        finally:
            engine.close()
        found.append(own)
    os.environ[VARIABLE] = json.dumps([asdict(own) for own in found])
    return [f"{own.name}: {said}" for own in found for said in own.said]


def whole(path: str | None) -> str:
    """A path that holds in other processes too; empty for none."""
    return str(Path(path).absolute()) if path else ""


def scenarios() -> dict[str, Scenario]:
    """Own scenes by name; none where none was asked for."""
    return dict(_of(os.environ.get(VARIABLE, "")))


@lru_cache(maxsize=2)
def _of(text: str) -> dict[str, Scenario]:
    return {own.name: own.scenario() for own in (OwnScene(**fields) for fields in json.loads(text or "[]"))}
