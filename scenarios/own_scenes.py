"""Scenes from a user's files in the place of the catalogue: MJCF, URDF, meshes, and recordings of `avatarsim live`.

Each process of a run reads the files again, so their names travel in the environment, which every process inherits.
"""

import json
import os
import re
from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from functools import cached_property, lru_cache, partial, reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from avatarsim.assets.models.load import FLOOR
from avatarsim.assets.models.model import Model, followed_by, in_room, with_carried
from avatarsim.clips.reading import Reading
from avatarsim.engine import Settings
from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.scene.carried import joined
from avatarsim.scene.checks import within
from avatarsim.scene.motion import Motion as Recording
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from runfiles.naming import GATED, OWN_PREFIX
from scenarios.building.promises import FINITE, NO_OVERLAP, WITHIN_LIMITS
from scenarios.engines import opened
from scenarios.motion.track import Track
from scenarios.scenario import RENDERED, Motion, Scenario

VARIABLE = "AVATARSIM_OWN_SCENES"
"""Environment variable with the scenes as JSON; empty or absent without any."""
QUICK = 600
"""Most frames of a quick comparison, ten seconds: three engines with some thirty settings take a minute for them."""
LONGEST = 3600.0
"""Longest scene [s]; longer ones do not fit into memory."""
MODELS = (".xml", ".mjcf", ".urdf")
"""Endings of files that may have joints."""
DRIVEN = ".live"
"""Ending of recordings of `avatarsim live`: scene and samples in one file."""
MARGIN = 1e-3
"""Free space [m] about the first posture, as in cleaning."""
AS_FOUND = Reading()
"""Options of readers by default."""
PathLike = str | Path | None
"""Path of a file; None for none."""


if TYPE_CHECKING:
    from avatarsim.assets.motions.motion_file import MotionFile


@dataclass(frozen=True)
class OwnScene:
    """Files of one scene; "" for one that is not given.

    seconds      length without a motion, and longest length with one
    scene_scale  metres a unit of length of the file
    reading      options of readers
    """

    name: str
    file: str
    avatar: str = ""
    room: str = ""
    motion: str = ""
    seconds: float = 5.0
    scene_scale: float = 1.0
    reading: Reading = AS_FOUND

    @cached_property
    def recorded(self) -> "MotionFile | None":
        """Motion file, None without one. Raises InvalidFile."""
        from avatarsim.clips.inputs import options_for, read

        path = Path(self.motion)
        return read(path, options_for(path, self.reading))[0] if self.motion else None

    @cached_property
    def models(self) -> tuple[Model, ...]:
        """Model with the avatar, if any has one, and those about it. Raises InvalidFile."""
        from avatarsim.assets.models.load import load_avatar, load_room

        of_avatar: dict[str, Any] = self.reading.of_avatar()
        rooms = [load_room(self.room, **self._of_room(self.room, True))] if self.room else []
        as_room = partial(load_room, self.file, **{**self._of_room(self.file, bool(self.avatar)), "scale": self.scene_scale})
        if self.avatar:
            return load_avatar(self.avatar, **of_avatar), as_room(), *rooms
        model, of_file = None, {**of_avatar, "scale": self.scene_scale}
        if Path(self.file).suffix.lower() in MODELS:
            model = load_avatar(self.file, **of_file, needed=False)
            if model.avatar is not None:
                return model, *rooms
        if self.recorded is not None:
            if (skeleton := self.recorded.model()) is not None:
                return skeleton, as_room(), *rooms
            if model is not None:
                # a loose body, which only a motion makes an avatar
                return load_avatar(self.file, **of_file), *rooms
        return model or as_room(), *rooms

    def _of_room(self, file: str, beside_avatar: bool) -> dict[str, Any]:
        return self.reading.of_room(Path(file).suffix.lower() in MODELS, beside_avatar)

    @cached_property
    def is_driven(self) -> bool:
        """Flag: the file is a recording of `avatarsim live`."""
        return Path(self.file).suffix.lower() == DRIVEN

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks of readers: units guessed, bodies raised, pairs left out of contact since they overlap in the file."""
        if self.is_driven:
            return ()
        motion = () if self.recorded is None else self.recorded.notes
        return tuple(dict.fromkeys([*motion, *(note for model in self.models for note in model.notes)]))

    def replayed(self) -> tuple[Scene, Track]:
        """Return scene and samples of a recording of `avatarsim live`, without commands in between.

        Raises InvalidFile for any other file, and for an avatar, room, motion or scale given with it.
        """
        from avatarsim.live.recording import Frame, read

        scale = "" if self.scene_scale == 1.0 else f"{self.scene_scale:g}"
        file = Path(self.file).name
        for option, other in (("avatar", self.avatar), ("room", self.room), ("motion", self.motion), ("scene-scale", scale)):
            if other:
                raise InvalidFile(f"--{option} beside {file}", other, "nothing: a recording has all of it")
        recording = read(Path(self.file))
        samples = [row.sample for row in recording.rows if isinstance(row, Frame)]
        if not samples or not recording.plan.scene.avatars:
            raise InvalidFile(f"frames of {file}", len(samples), "1 at least, of a scene with an avatar")
        driven = motion_of(samples, recording.plan.rate).resampled(1.0 / RENDERED)
        return replace(recording.plan.scene, name=self.name), Track(driven.positions, driven.rotations, driven.angles)

    def parts(self) -> tuple[Scene, Track | None]:
        """Return the scene with a free first posture, and the motion from there, None without one."""
        if self.is_driven:
            return self.replayed()
        # here and not above: to list the catalogue needs no compiler
        from avatarsim.cleaning.chords import Chords
        from avatarsim.cleaning.start import free_posture
        from avatarsim.clips.inputs import carried_in

        model, *rooms = self.models
        carried = () if self.recorded is None else carried_in(self.recorded, self.reading)
        together = with_carried(reduce(in_room, rooms, model), carried)
        scene = together.scene(self.name)
        if model.avatar is None:
            if self.motion:
                raise InvalidFile(f"avatar in {Path(self.file).name}", "none", "a file with joints, which --motion drives")
            return scene, None
        chords = Chords(scene)
        if self.recorded is None:
            return replace(scene, start=free_posture(chords, scene.first_sample, MARGIN)), None
        recorded = joined(self.recorded.motion(model), carried)
        recorded = followed_by(recorded, together.moving[len(carried) :]).resampled(1.0 / RENDERED)
        start = free_posture(chords, recorded.sample(0), MARGIN)
        track = Track(recorded.positions, recorded.rotations, recorded.angles).led_in(start)
        return replace(scene, start=start), track

    def scenario(self) -> Scenario:
        """Return the scenario: overlap, finite poses and limits are bounded, all else is measured."""
        frames = max(1, round(self.seconds / RENDERED))
        if (self.motion or self.is_driven) and (track := _parts(self)[1]) is not None:
            frames = min(frames, len(track))

        def motion(scene: Scene, seed: int) -> Motion:
            track = _parts(self)[1]
            if track is not None:
                return track.motion()
            return lambda frame: replace(scene.first_sample, time=(frame + 1) * RENDERED)

        limits = (WITHIN_LIMITS,) if _parts(self)[0].derived_effects.limits else ()
        files = " with ".join(Path(file).name for file in (self.file, self.motion) if file)
        return Scenario(
            name=self.name, title=f"A user's own scene: {files}.",
            judged="Overlap, numbers and limits, as promised; all else is measured without a bound.",
            build=lambda: _parts(self)[0], motion=motion, frames=frames, short=min(frames, QUICK),
            bounds=(NO_OVERLAP, FINITE, *limits), everyday=True,
        )


def motion_of(samples: Sequence[TrackerSample], rate: float) -> Recording:
    """Return samples at a rate [Hz] as a motion that can be played."""
    return Recording(
        np.arange(len(samples), dtype=np.float64) / rate, np.array([one.positions for one in samples]),
        np.array([one.rotations for one in samples]), np.array([one.angles for one in samples], dtype=np.float64),
    )


@lru_cache(maxsize=8)
def _parts(own: OwnScene) -> tuple[Scene, Track | None]:
    return own.parts()


def named(file: str, taken: Sequence[str]) -> str:
    """Return a scene's name from its file's: letters, digits and underscores, and a number where it is taken."""
    plain = OWN_PREFIX + (re.sub(r"[^a-z0-9]+", "_", Path(file).stem.lower()).strip("_")[:40] or "scene")
    names = (plain if k == 1 else f"{plain}_{k}" for k in range(1, len(taken) + 2))
    return next(name for name in names if name not in taken)


def take_files(
    files: Sequence[str], avatar: PathLike, room: PathLike, motion: PathLike, seconds: float, *,
    scene_scale: float = 1.0, reading: Reading = AS_FOUND,
) -> list[str]:
    """Put scenes of files, which share avatar, room and motion, in the place of the catalogue, here and in child processes.

    Returns remarks of readers. Raises InvalidFile, InvalidInput for an invalid length, StartOverlaps where bodies overlap.
    """
    within("--seconds [s]", seconds, RENDERED, LONGEST, InvalidInput)
    scenes: list[OwnScene] = []
    for file in files:
        own = OwnScene(
            named(file, [one.name for one in scenes]), _whole(file), _whole(avatar),
            FLOOR if str(room) == FLOOR else _whole(room), _whole(motion), seconds, scene_scale, reading,
        )
        with closing(opened(GATED[0])) as engine:
            engine.load(_parts(own)[0], Settings(), RENDERED)
        scenes.append(own)
    os.environ[VARIABLE] = json.dumps([asdict(own) for own in scenes])
    return [f"{own.name}: {note}" for own in scenes for note in own.notes]


def _whole(path: PathLike) -> str:
    """Return a path that is valid in other processes too, "" for none."""
    return str(Path(path).absolute()) if path else ""


def scenarios() -> dict[str, Scenario]:
    """Return own scenes by name."""
    return dict(_of(os.environ.get(VARIABLE, "")))


@lru_cache(maxsize=2)
def _of(text: str) -> dict[str, Scenario]:
    return {own.name: own.scenario() for own in map(_unpacked, json.loads(text or "[]"))}


def _unpacked(fields: dict[str, Any]) -> OwnScene:
    """Return the scene of a JSON object, in which tuples are lists."""
    reading: dict[str, Any] = fields.pop("reading")
    reading = {name: tuple(value) if isinstance(value, list) else value for name, value in reading.items()}
    return OwnScene(**fields, reading=Reading(**reading))
