"""Calls of pybullet as text that can be pasted into a program: names of arguments, numbers as they were given."""

from collections.abc import Iterable, Mapping

Arguments = Mapping[str, object]


class Name(str):
    """A word that is written into the text as it is, such as a variable of the reader's."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


def call(function: str, *positional: object, **named: object) -> str:
    """Return one line of Python."""
    given = [repr(value) for value in positional] + [f"{name}={value!r}" for name, value in named.items()]
    return f"pybullet.{function}({', '.join(given)})"


def grouped(rows: Iterable[tuple[str, Arguments]]) -> list[str]:
    """Return changeDynamics of many (body and link, arguments): one loop for all whose arguments agree to nine digits."""
    same: dict[tuple[tuple[str, object], ...], list[str]] = {}
    for where, arguments in rows:
        rounded = ((name, float(f"{value:.9g}") if isinstance(value, float) else value) for name, value in arguments.items())
        same.setdefault(tuple(rounded), []).append(where)
    lines = []
    for settings, places in same.items():
        line = call("changeDynamics", Name("body"), Name("link"), **dict(settings))
        lines += [f"for body, link in ({', '.join(places)},):", f"    {line}"]
    return lines
