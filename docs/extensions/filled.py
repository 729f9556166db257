"""Parts of pages that are made from the sources while the site is built, so that nothing is written twice.

A page marks the place with a comment, such as `<!-- public names -->`; `PARTS` maps it to its text. Links to folders, which a
repository's pages on the web can show and a site of files cannot, are left as their words.
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from sphinx.application import Sphinx

from docs.extensions import public_names, shared_pages
from runfiles.metrics import METRICS

ROOT = Path(__file__).resolve().parents[2]


def first_example() -> str:
    """Return the first program of the README, which a test runs."""
    code, *_ = re.findall(r"^```python\n.*?^```$", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    return str(code)


def terms_of_the_report() -> str:
    """Return the metrics of a run's report as a table."""
    rows = [f"| {one.label} | {one.definition.replace('|', chr(92) + '|')} |" for one in METRICS.values()]
    return "\n".join(["| metric | means |", "|---|---|", *rows])


def api() -> str:
    """Return the reference of the public names."""
    return "\n".join(public_names.page())


PARTS: Mapping[str, Callable[[], str]] = {
    "first example": first_example,
    "public names": api,
    "shared pages": shared_pages.links,
    "terms of the report": terms_of_the_report,
}
PLACE = re.compile(rf"^<!-- ({'|'.join(PARTS)}) -->$", re.MULTILINE)
LINK = re.compile(r"(?<!!)\[([^\[\]]+)\]\(([\w./-]+)\)")


def filled(text: str) -> str:
    """Return a page with its parts."""
    return PLACE.sub(lambda place: PARTS[place[1]](), text)


def without_folders(text: str, folder: Path) -> str:
    """Return a page, which lies in a folder, with the words of a link alone where that leads to a folder."""
    return LINK.sub(lambda link: link[1] if (folder / link[2]).is_dir() else link[0], text)


def read(app: Sphinx, page: str, source: list[str]) -> None:
    """Called by Sphinx when it has read a page, which is changed in place."""
    source[0] = filled(without_folders(source[0], (ROOT / page).parent))


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("source-read", read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
