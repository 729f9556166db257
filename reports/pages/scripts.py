"""Pages from templates: scripts and data inside them, and the security policy that lets nothing else run or be fetched."""

import base64
import gzip
import hashlib
import json
import math
from collections.abc import Sequence
from functools import cache
from importlib.resources import files as resources
from pathlib import Path
from typing import Any

import vl_convert
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from avatarsim.player import three_js
from reports.tables.figures import quantity
from runfiles.engines import about, run_label
from runfiles.metrics import label

FOLDER = Path(__file__).parents[1] / "templates"
PLAYER = resources("avatarsim.player")

LIBRARIES = "lib"
"""Folder beside index.html for the scripts that pages of scenes share."""

SNIPPET = "window.vegaEmbed = vegaEmbed;"
"""Export of the bundle: the only name that pages use."""


@cache
def _environment() -> Environment:
    """Return the templates, which know names and figures; text from outside stays text."""
    env = Environment(
        loader=FileSystemLoader(FOLDER), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    env.globals |= {"about": about, "run_label": run_label, "label": label, "quantity": quantity, "isfinite": math.isfinite}
    return env


def rendered(
    template: str, title: str, scripts: Sequence[str], payload: object, css: str = "", more: str = "",
    libraries: Sequence[str] = (), **values: Any,
) -> str:
    """Return a page.

    Args:
        template: its name.
        title: of the page.
        scripts: inside the page.
        payload: data for them.
        css: style sheet beyond that of all pages.
        more: allowed source of other scripts.
        libraries: paths of scripts beside the page, which run before those inside it.
        values: of the template.
    """
    return _environment().get_template(template).render(
        title=title, scripts=scripts, policy=policy(scripts, more, libraries), data=data(payload), css=source("base.css") + css,
        libraries=libraries, **values,
    )


def text(template: str, **values: Any) -> str:
    """Return a text that is no page, without empty lines."""
    return "\n".join(filter(None, _environment().get_template(template).render(**values).splitlines()))


def libraries() -> dict[str, str]:
    """Return the scripts that pages of scenes share, by their name in the folder LIBRARIES; three.js where it is installed."""
    player = [PLAYER.joinpath(name).read_text("utf-8") for name in ("gif.js", "player.js")]
    own = "".join([source("theme.js"), *player, source("scene.js")])
    three = three_js.library()
    return ({three_js.FILE: three} if three else {}) | {"vega.js": vega(), "scene.js": own}


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
    folder = resources("itables") / "html"
    return packed((folder / "dt_bundle.js").read_bytes()), packed((folder / "dt_bundle.css").read_bytes())


def packed(content: bytes) -> str:
    """Return bytes compressed, as text that a page unpacks when it needs them."""
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode("ascii")


def policy(scripts: Sequence[str], more: str = "", libraries: Sequence[str] = ()) -> str:
    """Return the content of a page's security policy: these scripts, inline styles, pictures from the page itself."""
    allowed = [f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'" for text in scripts]
    # pages are opened from disk, where not every browser takes 'self' for the page's own folder
    allowed += [more] * bool(more) + ["'self'", "file:"] * bool(libraries)
    return (
        f"default-src 'none'; script-src {' '.join(allowed) or chr(39) + 'none' + chr(39)}; style-src 'unsafe-inline'; "
        "img-src data: blob:; frame-src 'self'; font-src data:"
    )


def data(value: object) -> str:
    """Return JSON that cannot end the element it is in. Raises ValueError for a number that JSON cannot express."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
