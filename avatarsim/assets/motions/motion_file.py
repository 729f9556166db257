"""Interface of all readers of motion files: the motion for an avatar, and the file with another motion."""

from dataclasses import dataclass, field
from typing import Protocol

from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.object_poses import ObjectPoses
from avatarsim.scene.motion import Motion


class MotionFile(Protocol):
    """A file read whole and checked."""

    @property
    def format(self) -> str:
        """"bvh", "amc", "npz", "csv" or "deepmimic"."""

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences for the user: units guessed, columns ignored."""

    @property
    def object(self) -> ObjectPoses | None:
        """Poses of an object in addition to the motion; None without any."""

    def model(self) -> Model | None:
        """Return the avatar that the file contains (a skeleton); None where it needs a model."""

    def motion(self, model: Model) -> Motion:
        """Return the motion for this model's avatar; InvalidFile where its joints do not fit, by name."""

    def written(self, motion: Motion, model: Model) -> bytes:
        """Return the file with this motion instead of its own, in its format, to the last digit that float64 has."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Notes:
    """Notes of a reader for the user. More are added once the avatar's joints are known."""

    sentences: list[str] = field(default_factory=list)
    object: ObjectPoses | None = None

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences for the user."""
        return tuple(self.sentences)

    def model(self) -> Model | None:
        """Return None: the file has no avatar."""
        return None

    def note(self, sentence: str) -> None:
        """Add a sentence, once."""
        if sentence not in self.sentences:
            self.sentences.append(sentence)
