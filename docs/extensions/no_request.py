"""A built page fetches nothing: its scripts, styles, fonts and images are local files. The build fails if one is elsewhere."""

import re
from html.parser import HTMLParser
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

ELSEWHERE = re.compile(r"\s*(?:https?:|wss?:|ftp:|//)", re.IGNORECASE)
LOADED = {"src", "srcset", "poster", "data", "background"}
"""Attributes of which a browser loads the value by itself, whatever the element."""
LINKED = {
    "stylesheet", "icon", "preload", "prefetch", "modulepreload", "preconnect", "dns-prefetch", "manifest", "apple-touch-icon",
}
"""Kinds of `<link>` that make a browser request something; others only relate pages to each other."""
IN_STYLES = re.compile(r"(?:url\(|@import)\s*[\"']?([^\"')\s;]+)")


class Loads(HTMLParser):
    """Collects the addresses that a page makes a browser load from elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._in_style = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Look at the attributes of an element."""
        given = {name: value or "" for name, value in attrs}
        loaded = [value for name, value in given.items() if name in LOADED]
        if tag == "link" and LINKED & set(given.get("rel", "").lower().split()):
            loaded.append(given.get("href", ""))
        if tag in ("image", "use"):
            loaded += [given.get("href", ""), given.get("xlink:href", "")]
        if tag == "meta" and given.get("http-equiv", "").lower() == "refresh":
            loaded.append(given.get("content", "").partition("=")[2])
        self.found += [value for value in loaded if ELSEWHERE.match(value)] + from_styles(given.get("style", ""))
        self._in_style = tag == "style"

    def handle_endtag(self, tag: str) -> None:
        """A style sheet within the page ends."""
        self._in_style = False

    def handle_data(self, data: str) -> None:
        """Look into a style sheet within the page."""
        if self._in_style:
            self.found += from_styles(data)


def from_styles(text: str) -> list[str]:
    """Return addresses elsewhere that a style sheet names."""
    return [value for value in IN_STYLES.findall(text) if ELSEWHERE.match(value)]


def from_page(text: str) -> list[str]:
    """Return addresses elsewhere that a page loads."""
    parser = Loads()
    parser.feed(text)
    parser.close()
    return parser.found


def from_site(folder: Path) -> list[str]:
    """Return the same of all pages and style sheets of a folder, each with its file."""
    lines = []
    for file in sorted(folder.rglob("*")):
        if file.suffix in (".html", ".css", ".svg"):
            text = file.read_text(encoding="utf-8")
            lines += [f"{file.relative_to(folder)}: {one}" for one in (from_styles if file.suffix == ".css" else from_page)(text)]
    return lines


def finished(app: Sphinx, error: Exception | None) -> None:
    """Called by Sphinx when the pages are written."""
    if error is None and app.builder.format == "html" and (lines := from_site(Path(app.outdir))):
        raise ExtensionError("pages load something from elsewhere:\n" + "\n".join(lines))


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("build-finished", finished)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
