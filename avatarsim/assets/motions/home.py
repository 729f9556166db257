"""Home of a recorded human: the posture that stature, ranges of motion and pairs at rest are measured from.

It is the skeleton at rest if that is upright. A skeleton that is folded at rest takes it from a clip: then a finding on a frame
depends on where the clip is cut, unless the frame or another clip of the skeleton is stated.
"""

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from avatarsim.assets.models.anthropometry import parts
from avatarsim.assets.models.stance import stance
from avatarsim.assets.motions.measures import home_frame, standing
from avatarsim.assets.motions.recording import Recording
from avatarsim.errors import InvalidInput
from avatarsim.scene.motion import Motion

ENDINGS = (".amc", ".bvh")
"""Ends of names of files that a home may be taken from."""

VALID = 'a frame of the clip from 0, or another clip of the skeleton: 12, "walk.bvh" or "walk.bvh:12"'

STILL = 1e-6
"""Difference [m] up to which two offsets are equal: the accuracy of overlaps."""


@dataclass(frozen=True, eq=False)
class Home:
    """Home of one recording.

    clip       the posture, as a clip of one frame
    stature    standing height [m]
    is_stated  True for a posture that the user chose, which replaces an upright rest pose too"""

    clip: Motion
    stature: float
    is_stated: bool


def parsed_home(thing: str, home: object) -> tuple[Path | None, int | None]:
    """Return the file and the frame of a home, from text of a command line, a number or a path. Raises InvalidInput."""
    if home is None:
        return None, None
    word = str(home) if isinstance(home, (str, Path, int, np.integer)) and not isinstance(home, bool) else ""
    if re.fullmatch("[0-9]{1,12}", word):
        return None, int(word)
    found = re.fullmatch("(.+?)(?::([0-9]{1,12}))?", word, re.DOTALL)
    if found is None or Path(found[1]).suffix.lower() not in ENDINGS:
        raise InvalidInput(thing, home, VALID)
    return Path(found[1]), int(found[2]) if found[2] else None


@dataclass(frozen=True)
class StatedHome:
    """The user's choice of home for the clip `name`: another file, a frame of that file, or a frame of the clip itself."""

    name: str
    file: Path | None
    frame: int | None

    @classmethod
    def of(cls, name: str, home: object, frames: int) -> "StatedHome":
        """Return the home stated for a clip of so many frames. Raises InvalidInput for a frame that the clip does not have."""
        file, frame = parsed_home(f"home of {name}", home)
        if file is None and frame is not None and frame >= frames:
            raise InvalidInput(f"home of {name}", frame, f"a frame from 0 to {frames - 1}")
        return cls(name, file, frame)

    def measured(self, recording: Recording) -> Recording:
        """Return the frames by which units and the stature are measured: the stated one, else all."""
        return recording if self.file is not None or self.frame is None else recording.at([self.frame])

    def applied(self, recording: Recording, other: tuple[Recording, Home] | None) -> tuple[Recording, Home, list[str]]:
        """Return the recording on the skeleton of its home, the home, and a sentence where it depends on the clip.

        `other` is the content of another file. Raises InvalidInput for another skeleton and for a frame without a stance."""
        if other is not None:
            _require_same_skeleton(self.name, recording, other[0])
            own = replace(other[0].skeleton, name=recording.skeleton.name)
            return replace(recording, skeleton=own), other[1], []
        if self.frame is not None:
            part = self.measured(recording)
            if stance(part.skeleton, parts(part.skeleton), part.motion, at_rest=False)[0] is None:
                valid = "a frame with straight legs, of a skeleton whose hips, feet and head have known names"
                raise InvalidInput(f"home of {self.name}", f"frame {self.frame}", valid)
            return recording, Home(part.motion, standing(part), True), []
        _, frame = home_frame(recording)
        home = Home(recording.at([frame or 0]).motion, standing(recording), False)
        if frame is None:
            return recording, home, []
        kept = f'home="{self.name}:{frame}" keeps it for cuts and cleaned copies of the clip'
        return recording, home, [f"home of {self.name}, which is folded at rest: its frame {frame}, the most upright; {kept}"]


def _require_same_skeleton(name: str, recording: Recording, other: Recording) -> None:
    """Raise InvalidInput, by the first joint that differs, unless two recordings have equal skeletons."""
    thing, bones, wanted = f"home of {name}: %s in {other.thing}", recording.skeleton.bones, other.skeleton.bones
    for k, (bone, want) in enumerate(zip(bones, wanted, strict=False)):
        for what in ("name", "parent", "axes"):
            if getattr(bone, what) != getattr(want, what):
                raise InvalidInput(thing % f"{what} of joint {k}, {want.name},", getattr(want, what), f"{getattr(bone, what)}")
        for what, own, its in (("offset", (bone.offset,)[:k], (want.offset,)[:k]), ("tips", bone.tips, want.tips)):
            # means of varying places differ from clip to clip, and the root's is the place of its motion
            near = STILL + (_spread(recording, k) + _spread(other, k) if what == "offset" else 0.0)
            if len(own) != len(its) or not np.allclose(own, its, rtol=0.0, atol=near):
                raise InvalidInput(thing % f"{what} of {want.name}", its, f"{own} as in {name} [m]")
    if len(bones) != len(wanted):
        raise InvalidInput(thing % "number of joints", len(wanted), f"{len(bones)}, as in {name}")


def _spread(recording: Recording, k: int) -> float:
    """Return the extent [m] of the places of joint k on its parent."""
    columns = [column for column in recording.tracks[k].places if column >= 0]
    return recording.axes.scale * float(np.ptp(recording.values[:, columns], axis=0).max(initial=0.0))
