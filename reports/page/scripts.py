"""Scripts inside a page, and the rule that lets nothing else run or be fetched: their hashes in the page's security policy."""

import base64
import hashlib
import json
from collections.abc import Sequence
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "templates"


def source(name: str) -> str:
    """The text of one of our scripts."""
    return (FOLDER / name).read_text(encoding="utf-8")


def policy(scripts: Sequence[str]) -> str:
    """The content of the page's security policy: these scripts, inline styles, pictures from the page itself, no connection."""
    hashes = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'" for text in scripts)
    return f"default-src 'none'; script-src {hashes or chr(39) + 'none' + chr(39)}; style-src 'unsafe-inline'; img-src data:"


def data(value: object) -> str:
    """`value` as JSON that cannot end the element it stands in. Raises ValueError for a number that JSON has no word for."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
