"""A page as a reader and a browser see it."""

import json
import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

VOID = {"meta", "link", "input", "br", "hr", "img", "wbr", "path", "line", "rect", "circle"}
HIDDEN = ("script", "style", "svg", "title")


@dataclass
class Page:
    """What a page holds.

    ids      of its elements, in order
    links    (tag, attribute, address)
    cells    texts of table cells
    blocks   visible text, cut at each heading of the body
    scripts  (type, text) of scripts
    policy   of security
    unclosed  tags left open, or closed out of order
    """

    ids: list[str] = field(default_factory=list)
    links: list[tuple[str, str, str]] = field(default_factory=list)
    cells: list[str] = field(default_factory=list)
    blocks: list[str] = field(default_factory=lambda: [""])
    scripts: list[tuple[str, str]] = field(default_factory=list)
    policy: str = ""
    unclosed: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """All visible text."""
        return " ".join(self.blocks)


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.page, self.open = Page(), list[str]()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        named = {name: value or "" for name, value in attrs}
        page = self.page
        page.ids += [named["id"]] if "id" in named else []
        page.links += [
            (tag, name, named[name]) for name in ("href", "src", "xlink:href", "action", "srcset", "data") if name in named
        ]
        if named.get("http-equiv") == "Content-Security-Policy":
            page.policy = named["content"]
        if re.fullmatch(r"h[1-6]", tag):
            page.blocks.append("")
        if tag in ("td", "th"):
            page.cells.append("")
        if tag == "script":
            page.scripts.append((named.get("type", ""), ""))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID and (not self.open or self.open.pop() != tag):
            self.page.unclosed.append(tag)

    def handle_data(self, data: str) -> None:
        if "script" in self.open:
            kind, text = self.page.scripts[-1]
            self.page.scripts[-1] = (kind, text + data)
        if any(tag in self.open for tag in HIDDEN):
            return
        self.page.blocks[-1] += data + " "
        if "td" in self.open or "th" in self.open:
            self.page.cells[-1] += data


def data_of(path: Path) -> list[Any]:
    """Data of a page; the test fails where a number is none that JSON has."""
    scripts = read(path).scripts
    return [json.loads(text, parse_constant=pytest.fail) for kind, text in scripts if kind == "application/json"]


def read(path: Path) -> Page:
    """Read a page."""
    reader = _Reader()
    reader.feed(path.read_text(encoding="utf-8"))
    reader.close()
    reader.page.unclosed += reader.open
    return reader.page
