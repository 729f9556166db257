"""A file of a recorded clip with its own skeleton: its human avatar, its motion, and whether another avatar fits it."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

from avatarsim.assets.models.ball_limits import Beyond, beyond_limits
from avatarsim.assets.models.from_skeleton import human
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.home import Home
from avatarsim.assets.motions.recording import Recording
from avatarsim.errors import InvalidFile
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Hinges
from avatarsim.scene.motion import Motion


@dataclass(frozen=True, eq=False, kw_only=True)
class RecordedFile:
    """Common part of the formats of recorded skeletons.

    name       of the file, for sentences
    recording  its clip on its skeleton
    home       the posture for measurements of its avatar
    notes      sentences on guesses
    mass       of the avatar [kg]
    limits     whether its joints of known name have their range of motion"""

    name: str
    recording: Recording
    home: Home
    notes: tuple[str, ...]
    mass: float
    limits: bool
    object: ClassVar[None] = None

    @cached_property
    def _model(self) -> Model:
        recording, home = self.recording, self.home
        model = human(recording.skeleton, home.stature, home.clip, self.mass, self.limits, not home.is_stated)
        assert model.avatar is not None
        return replace(model, notes=(*model.notes, *limits_note(self.name, model.avatar, recording.motion_within(model.avatar))))

    def model(self) -> Model:
        """Return the human avatar of the file's skeleton; its notes list the joints that the recording takes beyond limits."""
        return self._model

    def motion(self, model: Model) -> Motion:
        """Return the clip as recorded, regardless of joint limits; InvalidFile unless `model` has the file's joints."""
        self.require_own(model)
        assert model.avatar is not None
        return self.recording.motion_within(model.avatar)

    def beyond_limits(self, model: Model) -> tuple[Beyond, ...]:
        """Return the joints that the clip takes beyond this avatar's limits, worst first, with number of frames and excess."""
        motion = self.motion(model)
        assert model.avatar is not None
        return beyond_limits(model.avatar, motion)

    def require_own(self, model: Model) -> None:
        """Raise InvalidFile, by the name of the first joint that does not fit, unless `model` has the file's tree and joints."""
        own, links = self._model.avatar, () if model.avatar is None else model.avatar.links
        assert own is not None
        for k, want in enumerate(own.links):
            link = links[k] if k < len(links) else None
            if link is None or (link.name, link.parent) != (want.name, want.parent):
                thing = f"link {k} of the avatar for {self.name}"
                raise InvalidFile(thing, link and link.name, f"{want.name}: the file brings its own avatar")
            has, needs = (len(one.hinges) if isinstance(one, Hinges) else type(one).__name__ for one in (link.joint, want.joint))
            if has != needs:
                raise InvalidFile(f"joint of {link.name}", link.joint, f"one as {want.joint}, which {self.name} has turns for")
        if len(links) > len(own.links):
            beyond = links[len(own.links)].name
            raise InvalidFile(f"link of the avatar for {self.name}", beyond, "none: the file has no such joint")


def limits_note(name: str, avatar: Avatar, motion: Motion) -> tuple[str, ...]:
    """Return a sentence on the joints that a recording takes beyond its avatar's limits; none where it takes none."""
    beyond = beyond_limits(avatar, motion)
    if not beyond:
        return ()
    listed = ", ".join(f"{one.joint} ({one.frames} frames, up to {one.text})" for one in beyond)
    leaves = f"{name} itself leaves limits of joints in its {len(motion)} frames, and is clipped to them when run"
    return (f"{leaves}: {listed}",)
