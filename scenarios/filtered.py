"""Which scenes do the patterns of `--filter` let through, and which pattern is a slip of the hand?"""

from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from typing import TypeVar

Scene = TypeVar("Scene")


def patterns_of(text: str) -> list[str]:
    """Patterns with commas between them; blanks beside these do not count."""
    return [pattern.strip() for pattern in text.split(",")]


def unmatched(names: Iterable[str], text: str) -> list[str]:
    """The patterns that match none of the names."""
    known = list(names)
    return [pattern for pattern in patterns_of(text) if not any(fnmatchcase(name, pattern) for name in known)]


def filtered(scenes: Mapping[str, Scene], text: str) -> dict[str, Scene]:
    """Scenes by name that a pattern lets through; none if one of the patterns matches nothing: who misspells a name in a list
    would otherwise believe that its scene held."""
    if unmatched(scenes, text):
        return {}
    patterns = patterns_of(text)
    return {name: scene for name, scene in scenes.items() if any(fnmatchcase(name, pattern) for pattern in patterns)}
