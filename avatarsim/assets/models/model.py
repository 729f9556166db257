"""What one file of a robot, a hand or a room gives."""

from dataclasses import dataclass

from avatarsim.assets.models.coordinates import Coordinates
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample


@dataclass(frozen=True, eq=False)
class Model:
    """An avatar, the bodies about it, or both.

    avatar       the driven tree of links; None for a file that is only a room
    coordinates  the avatar's generalized coordinates in the file's own order; None without an avatar
    bodies       the fixed room and loose bodies
    said         sentences for the user: what was excluded, fixed, guessed
    exclude      pairs of names that never touch, besides those of the avatar itself, as in `Scene.exclude`
    start        the avatar's posture at the file's reference, within limits, where it is free; None without an avatar
    at_rest      of the pairs that never touch, by their names in a scene, those that do not since they overlap at the file's
                 reference or, of a recorded skeleton, standing or in the first frame; the others are the file's own word"""

    avatar: Avatar | None
    coordinates: Coordinates | None
    bodies: tuple[Body, ...]
    said: tuple[str, ...]
    exclude: tuple[tuple[str, str], ...] = ()
    start: TrackerSample | None = None
    at_rest: tuple[tuple[str, str], ...] = ()

    def scene(self, name: str = "model") -> Scene:
        """All of it as a scene, at its start."""
        avatars = () if self.avatar is None else (self.avatar,)
        return Scene(name, self.bodies, avatars, start=self.start, exclude=self.exclude)
