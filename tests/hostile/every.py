"""All doors by name."""

from functools import cache

from tests.hostile import bad_doors
from tests.hostile.doors import Door


@cache
def doors() -> dict[str, Door]:
    """Doors for files, for values, for command lines, for messages."""
    # only here: they import all that is tested, which takes a second
    from tests.hostile import constructors, messages, readers, words

    return {door.name: door for door in (*readers.doors(), *constructors.doors(), *words.doors(), *messages.doors())}


def door_named(name: str) -> Door:
    """One of them, or one of the bad ones that campaigns are tested with. KeyError for a name that none has."""
    bad = bad_doors.doors()
    return bad[name] if name in bad else doors()[name]
