"""Static pages of the WebSocket server, with a security policy that limits their requests to this server (CSP level 3)."""

from functools import cache
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).parent / "page"
"""Folder of the served files; only those named here are served."""
FILES = {"/hands": "hands.html", "/hands.css": "hands.css", "/hands.js": "hands.js", "/hand_joints.js": "hand_joints.js"}
KINDS = {".html": "text/html; charset=utf-8", ".css": "text/css; charset=utf-8", ".js": "text/javascript; charset=utf-8"}


class Page(NamedTuple):
    """Body and headers of a response."""

    body: bytes
    headers: dict[str, str]


@cache
def page(path: str) -> Page | None:
    """Return the file at a path of the server, or None."""
    name = FILES.get(path)
    if name is None:
        return None
    policy = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; frame-ancestors 'none'"
    headers = {
        "Content-Type": KINDS[Path(name).suffix], "Content-Security-Policy": policy, "X-Content-Type-Options": "nosniff",
        "Cross-Origin-Resource-Policy": "same-origin", "Cache-Control": "no-store",
    }
    return Page((FOLDER / name).read_bytes(), headers)
