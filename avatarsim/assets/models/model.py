"""What one file of a robot, a hand or a room gives."""

from dataclasses import dataclass

from avatarsim.assets.models.coordinates import Coordinates
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body


@dataclass(frozen=True, eq=False)
class Model:
    """An avatar, the bodies about it, or both.

    avatar       the driven tree of links; None for a file that is only a room
    coordinates  the avatar's generalized coordinates in the file's own order; None without an avatar
    bodies       the fixed room and loose bodies
    said         sentences for the user: what was excluded, fixed, guessed"""

    avatar: Avatar | None
    coordinates: Coordinates | None
    bodies: tuple[Body, ...]
    said: tuple[str, ...]
