"""Where the page of a scene stands beside index.html."""

import re

from avatarsim.errors import InvalidFile

FOLDER = "scenes"
PLAIN = re.compile(r"\w[\w.-]*")
"""What a scene may be called: its page's file has the same name."""


def path_of(scene: str) -> str:
    """Path from the run's folder. Raises InvalidFile for a name that is no plain file name."""
    if not PLAIN.fullmatch(scene):
        raise InvalidFile("name of a scene in results.json", scene, "letters, digits, and . _ - after the first")
    return f"{FOLDER}/{scene}.html"
