"""Links and names of files in the repository's Markdown lead to something that is there."""

import pkgutil
import re
from pathlib import Path
from types import ModuleType

import pytest

import avatarsim

ROOT = Path(__file__).resolve().parents[2]
PAGES = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md"))]
IDS = [str(page.relative_to(ROOT)) for page in PAGES]
OLD = {"CHANGELOG.md"}
"""History: files are named as they were called then."""
LINK = re.compile(r"\]\(([^)\s]+)\)")
SPAN = re.compile(r"`([^`\n]+)`")
FILE = re.compile(
    r"(?!reports/out/)(?:[\w.-]+(?:/[\w.-]+)+\.(?:py|toml|md|json|js|csv)"
    r"|(?:avatarsim|docs|reference|reports|scenarios|tests)/(?:[\w.-]+/)*)"
)
"""Files with their folders, and folders of the repository; the files of a run in reports/out are in no checkout."""
DOTTED = re.compile(r"avatarsim(?:\.\w+)+")
GROUP = "avatarsim.engines"
"""Of entry points, and no module."""
FOLDERS = ("", "avatarsim", "scenarios", "reports")
"""Where a file may be counted from."""


def prose(text: str) -> str:
    """Return a page without its fenced blocks."""
    return re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)


def anchors(text: str) -> set[str]:
    """Return anchors of a page's headings, as GitHub and MyST make them."""
    headings = re.findall(r"^#+ (.*)$", prose(text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def broken_links(page: Path) -> list[str]:
    """Return links inside the repository that lead nowhere."""
    found = []
    for link in LINK.findall(prose(page.read_text(encoding="utf-8"))):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = page.parent / path if path else page
        if not target.exists():
            found.append(link)
        elif anchor and anchor not in anchors(target.read_text(encoding="utf-8")):
            found.append(link)
    return found


def is_there(dotted: str) -> bool:
    """Return whether a dotted name is a module, or a name that one has; parts below that name are not looked at."""
    found: object = avatarsim
    for part in dotted.split(".")[1:]:
        try:
            found = pkgutil.resolve_name(f"{found.__name__}.{part}") if isinstance(found, ModuleType) else found
        except (ImportError, AttributeError):
            return False
    return True


def broken_names(page: Path) -> list[str]:
    """Return files, folders and dotted names in code spans that are not there."""
    found = []
    for span in SPAN.findall(prose(page.read_text(encoding="utf-8"))):
        if FILE.fullmatch(span) and not any((ROOT / folder / span).exists() for folder in FOLDERS):
            found.append(span)
        if DOTTED.fullmatch(span) and span != GROUP and not is_there(span):
            found.append(span)
    return found


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_links_inside_the_repository_lead_somewhere(page: Path) -> None:
    assert broken_links(page) == []


@pytest.mark.parametrize("page", [page for page in PAGES if page.name not in OLD], ids=[one for one in IDS if one not in OLD])
def test_files_and_names_that_are_spoken_of_are_there(page: Path) -> None:
    assert broken_names(page) == []


def test_what_is_broken_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "# A heading: one\n[a](page.md#a-heading-one) [b](page.md#two) [c](gone.md) [d](https://there) `avatarsim/gone.py`\n"
        "`avatarsim.frame.Frames.frame` `avatarsim.frame.Gone` `ik/solve.py` `tests/gone/`\n```\n[e](gone2.md)\n```\n",
        encoding="utf-8",
    )
    assert broken_links(page) == ["page.md#two", "gone.md"]
    assert broken_names(page) == ["avatarsim/gone.py", "avatarsim.frame.Gone", "tests/gone/"]
