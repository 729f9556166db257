"""All doors by name."""

from functools import cache

from tests.hostile import constructors, readers, words
from tests.hostile.doors import Door


@cache
def doors() -> dict[str, Door]:
    """Doors for files, for values, for command lines."""
    return {door.name: door for door in (*readers.doors(), *constructors.doors(), *words.doors())}


def door_named(name: str) -> Door:
    """One of them. KeyError for a name that none has."""
    return doors()[name]
