"""What every reader of motion files gives: the motion for an avatar, and the same file with another motion."""

from dataclasses import dataclass, field
from typing import Protocol

from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.object_poses import ObjectPoses
from avatarsim.scene.motion import Motion


class MotionFile(Protocol):
    """A file that was read whole and checked."""

    @property
    def format(self) -> str:
        """"bvh", "amc", "npz", "csv" or "deepmimic"."""

    @property
    def said(self) -> tuple[str, ...]:
        """Sentences for the user: units guessed, columns left alone."""

    @property
    def object(self) -> ObjectPoses | None:
        """The poses of an object beside the motion; None without any."""

    def model(self) -> Model | None:
        """The avatar that the file brings itself (a skeleton); None where it needs a model."""

    def motion(self, model: Model) -> Motion:
        """The motion for this model's avatar; InvalidFile where its joints do not fit, by name."""

    def written(self, motion: Motion, model: Model) -> bytes:
        """The file again with this motion instead of its own, in the same format, to the last digit that float64 has."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Notes:
    """Notes of a reader for the user. More are added once the joints of the avatar are known."""

    notes: list[str] = field(default_factory=list)
    object: ObjectPoses | None = None

    @property
    def said(self) -> tuple[str, ...]:
        """Sentences for the user."""
        return tuple(self.notes)

    def model(self) -> Model | None:
        """None: the file brings no avatar."""
        return None

    def note(self, sentence: str) -> None:
        """Add a sentence, once."""
        if sentence not in self.notes:
            self.notes.append(sentence)
