"""Pages from templates: scripts and data inside them, and the security policy that lets nothing else run or be fetched."""

import base64
import gzip
import hashlib
import json
import math
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import vl_convert
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from reports.tables.figures import quantity
from runfiles.engines import about, run_label
from runfiles.metrics import label

FOLDER = Path(__file__).parents[1] / "templates"

SNIPPET = "window.vegaEmbed = vegaEmbed;"
"""Export of the bundle: the only name that pages use."""


@cache
def _environment() -> Environment:
    """Return the templates, which know names and figures; text from outside stays text."""
    found = Environment(
        loader=FileSystemLoader(FOLDER), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    found.globals |= {"about": about, "run_label": run_label, "label": label, "quantity": quantity, "isfinite": math.isfinite}
    return found


def rendered(
    template: str, title: str, scripts: Sequence[str], payload: object, css: Sequence[str] = (), more: str = "", **values: Any
) -> str:
    """Return a page with these scripts, data for them, style sheets beyond that of all pages, and ``more`` allowed sources."""
    return _environment().get_template(template).render(
        title=title, scripts=scripts, policy=policy(scripts, more), data=data(payload),
        css="".join(map(source, ("base.css", *css))), **values,
    )


def source(name: str) -> str:
    """Return the text of a template folder's script or style sheet."""
    return (FOLDER / name).read_text(encoding="utf-8")


@cache
def vega() -> str:
    """Return Vega, Vega-Lite and Vega-Embed as one script that defines `vegaEmbed`."""
    return str(vl_convert.javascript_bundle(SNIPPET)).replace("</script", "<\\/script")


@cache
def data_tables() -> tuple[str, str]:
    """Return script (an ES module) and style sheet of DataTables, packed."""
    folder = files("itables") / "html"
    return packed((folder / "dt_bundle.js").read_bytes()), packed((folder / "dt_bundle.css").read_bytes())


def packed(content: bytes) -> str:
    """Return bytes compressed, as text that a page unpacks when it needs them."""
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode("ascii")


def policy(scripts: Sequence[str], more: str = "") -> str:
    """Return the content of a page's security policy: these scripts, inline styles, pictures from the page itself."""
    hashes = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'" for text in scripts)
    return (
        f"default-src 'none'; script-src {hashes or chr(39) + 'none' + chr(39)}{more}; style-src 'unsafe-inline'; "
        "img-src data: blob:; frame-src 'self'; font-src data:"
    )


def data(value: object) -> str:
    """Return JSON that cannot end the element it is in. Raises ValueError for a number that JSON cannot express."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
