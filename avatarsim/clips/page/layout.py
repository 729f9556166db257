"""HTML of a page that loads nothing from elsewhere: one style, one script allowed by its hash, data (Content Security Policy 3).

Every text that comes from a file goes through `html.escape`; data goes as JSON in which `<` is written as its code.
"""

import base64
import hashlib
import html
import json
import math
import os
from collections.abc import Mapping
from importlib.resources import files as resources
from urllib.parse import quote

from avatarsim.console import printable

GENERATOR = '<meta name="generator" content="avatarsim clean">'
"""Mark near the beginning of each page: files with it may be overwritten."""

ROUNDING = 1e-9
"""Angle treated as zero [rad]: within it joints count as within their limits."""


def resource(name: str, package: str = "avatarsim.clips.page") -> str:
    """Return the text of a file of a package's folder, as the wheel contains it."""
    return resources(package).joinpath(name).read_text("utf-8")


def esc(text: object) -> str:
    """Escape any text as HTML, also within attributes; unprintable characters by their codes."""
    return html.escape(printable(str(text)), quote=True)


def address(name: str) -> str:
    """Return the path of a file below the folder as an address; its separators stay."""
    try:
        return esc(quote(os.fsencode(name)))
    except UnicodeEncodeError:
        # no file has such a name
        return esc(quote(name, errors="replace"))


def data(name: str, value: object) -> str:
    """Return a value in the form that the page's script reads."""
    content = json.dumps(value, allow_nan=False, separators=(",", ":"))
    for letter in "<>&":
        content = content.replace(letter, f"\\u{ord(letter):04x}")
    return f'<script type="application/json" id="{esc(name)}">{content}</script>'


def _hash(content: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()}'"


def page(title: str, body: str, script: str = "", style: str = "", library: str = "") -> bytes:
    """Return a whole page, which fetches nothing but ``library``.

    Args:
        title: of the page, any text.
        body: HTML.
        script: JavaScript, which the policy allows by its hash.
        style: CSS beyond that of all pages.
        library: path of a script next to the page, loaded before ``script``.
    """
    css = resource("page.css") + style
    scripts = " ".join(([_hash(script)] if script else []) + (["'self'", "file:"] if library else [])) or "'none'"
    policy = (
        f"default-src 'none'; style-src {_hash(css)}; script-src {scripts}; img-src data: blob:; base-uri 'none'; "
        "form-action 'none'"
    )
    code = f'<script src="{esc(library)}"></script>\n' if library else ""
    code += f"<script>{script}</script>\n" if script else ""
    whole = (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{esc(title)}</title>\n'
        f'{GENERATOR}\n<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{esc(policy)}">\n<style>{css}</style>\n</head>\n'
        f"<body>\n{body}\n{code}</body>\n</html>\n"
    )
    return whole.encode()


def length(metres: object) -> str:
    """Format a length with three digits, in a suitable unit."""
    if not isinstance(metres, int | float):
        return "—"
    for unit, size in (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6)):
        if abs(metres) >= size:
            return f"{metres / size:.3g} {unit}"
    return "0" if metres == 0 else f"{metres / 1e-9:.3g} nm"


def angle(radians: object) -> str:
    """Format an angle in degrees with three digits; rounding errors are shown as 0."""
    if not isinstance(radians, int | float):
        return "—"
    return "0" if abs(radians) <= ROUNDING else f"{math.degrees(radians):.3g}°"


def limit_excess(limits: Mapping[str, object], when: str) -> str:
    """Return the largest excess over limits of joints and, if there are any, of slides; `when` is "before" or "after"."""
    turned, slid = angle(limits[f"excess_{when}_rad"]), limits[f"slide_excess_{when}_m"]
    return f"{turned}, {length(slid)}" if slid else turned


def table(head: list[str], rows: list[list[str]]) -> str:
    """Return a table of HTML cells; on a narrow screen each cell shows its head next to it."""
    top = "".join(f"<th scope=col>{cell}</th>" for cell in head)
    lines = [
        "<tr>" + "".join(f'<td data-label="{esc(label)}">{cell}</td>' for label, cell in zip(head, row, strict=True)) + "</tr>"
        for row in rows
    ]
    return f"<div class=scroll><table><thead><tr>{top}</tr></thead><tbody>\n" + "\n".join(lines) + "\n</tbody></table></div>"
