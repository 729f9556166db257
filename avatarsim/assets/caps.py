"""Limits on untrusted files: the most that a reader accepts before it allocates by sizes that the file states.

A reader that allocates by stated sizes alone lets a file of a few bytes take the machine's memory or a day. So each quantity is
compared with a limit first. Together the limits keep a reader below 1 GB and 5 s."""

from pathlib import Path

from avatarsim.errors import InvalidFile
from avatarsim.files import read_bytes

BYTES = 2**28
"""Bytes of a file, and of all unpacked arrays of an archive (268 MB). A retargeted hour of a robot with its body poses has
200 MB. More: file, arrays and motion, several times as large, are in memory together, and 1 GB is passed."""

TEXT_BYTES = 2**26
"""Bytes of a table of numbers as text (67 MB): an hour and a half of a robot with 29 joints at 30 Hz. More: parsing takes more
than 5 s."""

JSON_BYTES = 2**24
"""Bytes of a motion in JSON (16.8 MB): ten minutes of 44 columns at 30 Hz. A list takes 60 bytes of memory and 3 of a file, so
that a file of empty lists takes twenty times its size. More: 1 GB is passed."""

LINKS = 512
"""Links of an avatar, joints of a skeleton. The largest model known here, a body with hands, has 120. More: the posture solver's
matrices grow with the square, and a frame takes a second."""

BODIES = 4_096
"""Bodies of a scene in a file. The largest scene known here has a twentieth of it. More: loading 10,000 takes 5 s and 1 GB."""

FRAMES = 1_000_000
"""Frames of a motion: two hours at 120 Hz. More: each frame takes some work even if small, and a run would take days."""

LINK_FRAMES = 5_000_000
"""Frames times links of a motion: 25 minutes of a robot with 30 links at 100 Hz. A link of a frame is 7 numbers, so this is
280 MB, and twice that while the motion is read and resampled. More: 1 GB is passed."""

VERTICES = 2_000_000
"""Vertices of the meshes of a model. The largest scan known here has a fifteenth of it. More: checking and cutting them takes
minutes."""

MATERIALS = 200
"""Different frictions of a model's geoms. The most known here are 10. More: the table of their pairs grows with the square."""

KEYFRAMES = 1_000
"""Keyframes of a model. The most known here are 30. More: each has all coordinates."""

NAME = 200
"""Characters of a name: of a joint, a body, an entry of an archive. The longest known here has 60. More: a message that names
ten of them fills a screen."""

ENTRIES = 1_000
"""Arrays of an archive. The most known here has 30. More: each has a header to parse, 50 microseconds and more."""

LINES = 4_000_000
"""Lines of a text. AMC has one for each bone and frame, CMU's longest 600,000. More: each takes 50 bytes and up."""

LINE = 2**18
"""Characters of a line of a skeleton's motion: six numbers of 80 characters for each of LINKS joints. More: one line is all."""

NUMBER = 1e9
"""Largest magnitude of a number in any unit of a file: larger angles and distances have lost their digits."""

COLUMNS = 10_000
"""Numbers of a frame in a table: 512 links with their poses need 3,600. More: splitting one line of text fills the memory."""


def content(path: Path, thing: str, valid: str, most: int = BYTES) -> bytes:
    """Return all bytes of a regular file within `most`. Raises InvalidFile, which calls the file `thing`."""
    return read_bytes(path, thing, valid, most)


def require_frames(name: str, frames: int, links: int = 1) -> None:
    """Raise InvalidFile unless a motion of so many frames and links is within the limits; `name` is the file's."""
    if frames > FRAMES:
        raise InvalidFile(f"frames of {name}", frames, f"up to {FRAMES}; cut it into shorter files")
    if frames * links > LINK_FRAMES:
        most = LINK_FRAMES // links
        raise InvalidFile(f"frames of {name}", frames, f"up to {most} for an avatar of {links} links; cut it into shorter files")


def require_name(thing: str, name: str) -> str:
    """Return `name`, unless it is empty, longer than NAME or contains unprintable characters: InvalidFile."""
    if not name or len(name) > NAME or not name.isprintable():
        raise InvalidFile(thing, name, f"1 to {NAME} printable characters")
    return name
