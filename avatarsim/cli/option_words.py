"""Messages of the library rewritten for the command line: `fix=("elbow", ...)` is `--fix elbow,...` there.

Readers advise in Python, since they are called from there; a command prints their sentences with its own options.
"""

import re
import shlex
from collections.abc import Collection

from avatarsim.cli.arguments import options_of
from avatarsim.clips.options import OPTIONS

VALUE = r"\"[^\"]*\"|'[^']*'|\([^()]*\)|True|False|\.\.\.|[A-Z]+\.npz|[0-9.]+(?![\w.])"
"""A value as sentences write it: a text, a tuple of texts, a bool, three dots, a file's name in capitals, a number."""

ARGUMENT = re.compile(rf"(?<![\w.-])([a-z][a-z_]*)=({VALUE})?(?=(\S)?)")
"""An argument, its value if it has one, and the character after it."""

PHRASES = {
    "size_range widens this": ("avatar-scale", "--avatar-scale gives another unit"),
    "motion.resampled(rate) makes them": ("margin", "--rate makes them"),
    "load_room reads a room": ("room", "--room takes a room"),
}
"""Phrases about Python: each with the option that a command needs for it, and its form on the command line."""


def in_words(sentence: str, command: str) -> str:
    """Return the sentence with the options of a command of `avatarsim`."""
    return as_options(sentence, options_of(command))


def as_options(sentence: str, options: Collection[str]) -> str:
    """Return the sentence with arguments that are among a command's `options` as such; others stay unchanged."""

    def option(match: re.Match[str]) -> str:
        argument, value, after = match[1], match[2] or "", match[3]
        name = OPTIONS.get(argument, argument.replace("_", "-"))
        if name not in options:
            return match[0]
        shell_value = _shell_value(value)
        return f"--{name}{f' {shell_value}' if shell_value else ''}" + (" " if not value and after else "")

    for phrase, (needed, words) in PHRASES.items():
        if needed in options:
            sentence = sentence.replace(phrase, words)
    return ARGUMENT.sub(option, sentence)


def _shell_value(value: str) -> str:
    """Return a value as a shell takes it."""
    if value.startswith("("):
        names = [name for pair in re.findall(r"\"([^\"]*)\"|'([^']*)'", value) for name in pair if name]
        # a tuple with three dots contains no real name
        return ",".join(filter(None, [shlex.quote(",".join(names)) if names else "NAME", "..." if "..." in value else ""]))
    if value in ("", "True", "False"):
        return ""
    return "DIR" if value == "..." else shlex.quote(value.strip("\"'"))
