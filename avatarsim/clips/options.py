"""Options of a command: avatar and room, how files are read, and how motions are cleaned."""

from dataclasses import dataclass, fields
from pathlib import Path

from avatarsim.cleaning import Options
from avatarsim.clips.reading import Reading

OPTIONS = {"avatar": "body", "rate": "file-rate", "skeleton": "asf", "limits": "no-limits"}
"""Arguments of readers that have another name on the command line."""

FLOOR = "floor"
"""Value for level ground in place of a room's file."""


@dataclass(frozen=True)
class ClipOptions:
    """All options that determine the result of a motion.

    avatar, room   files; None for the skeleton that a motion brings, and for no room
    rate           frames a second at which motions are cleaned and written [1/s]; None: their own
    reading        how files are read
    ground         height of the ground in motions [m]; None: as recorded, and found where every frame is in the room
    cleaning       how motions are cleaned
    page           whether a page is made of each clip"""

    avatar: Path | None = None
    room: Path | None = None
    rate: float | None = None
    reading: Reading = Reading()
    ground: float | None = None
    cleaning: Options = Options()
    page: bool = True

    def as_json(self) -> dict[str, object]:
        """Return all options as JSON, files by their names: a certificate does not depend on the machine."""
        reading = {field.name: getattr(self.reading, field.name) for field in fields(Reading)}
        for name in ("asf", "folder", "home", "offsets", "object_file"):
            if reading[name] is not None:
                reading[name] = Path(reading[name]).name
        return {
            "avatar": self.avatar.name if self.avatar else None, "room": self.room.name if self.room else None,
            "rate_hz": self.rate, "ground_m": self.ground,
            "reading": {name: list(value) if isinstance(value, tuple) else value for name, value in reading.items()},
            "cleaning": {field.name: getattr(self.cleaning, field.name) for field in fields(Options)}, "page": self.page,
        }
