"""Markdown escapes (CommonMark, with tables): text from a run's files stands in summary.md as text, as it does on the pages.

Without them the name of a scene, or what a crashed engine said, could open a tag, begin a picture that is fetched, or end a cell.
"""

import re
from html import escape

ACTIVE = re.compile(r"[\\`*\[\]|~]|(?<=:)/(?=/)|^#")
"""What begins markup within a line, a heading at its beginning, and the address that a renderer would make a link of."""


def escaped(raw: str) -> str:
    """`raw` on one line, with nothing in it that renders."""
    return ACTIVE.sub(r"\\\g<0>", escape(" ".join(raw.split()), quote=False))


def code(raw: str) -> str:
    """`raw` as code, within which nothing but a backtick has a meaning."""
    return f"`{' '.join(raw.split()).replace('`', chr(39))}`"
