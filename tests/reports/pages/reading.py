"""A page as seen by a reader and a browser."""

import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

VOID = {"meta", "link", "input", "br", "hr", "img", "wbr", "path", "line", "rect", "circle"}
HIDDEN = {"script", "style", "svg", "title"}
ADDRESSES = ("href", "src", "xlink:href", "action", "srcset", "data")


class Page(HTMLParser):
    """Parts of a page: ids, links, texts and tags.
    Links (tag, attribute, address), table cells, visible text, scripts (type, text), security policy, unbalanced tags."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.ids, self.cells, self.unclosed, self._open = (list[str]() for _ in range(4))
        self.links, self.scripts = list[tuple[str, str, str]](), list[tuple[str, str]]()
        self.text = self.policy = ""
        self.feed(html)
        self.close()
        self.unclosed += self._open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        named = {name: value or "" for name, value in attrs}
        self.ids += [named["id"]] if "id" in named else []
        self.links += [(tag, name, named[name]) for name in ADDRESSES if name in named]
        if named.get("http-equiv") == "Content-Security-Policy":
            self.policy = named["content"]
        if tag in ("td", "th"):
            self.cells.append("")
        if tag == "script":
            self.scripts.append((named.get("type", ""), ""))
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self._open.pop()

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID and (not self._open or self._open.pop() != tag):
            self.unclosed.append(tag)

    def handle_data(self, data: str) -> None:
        if "script" in self._open:
            kind, text = self.scripts[-1]
            self.scripts[-1] = (kind, text + data)
        if not HIDDEN & set(self._open):
            self.text += data + " "
            if {"td", "th"} & set(self._open):
                self.cells[-1] += data


def read(path: Path) -> Page:
    return Page(path.read_text(encoding="utf-8"))


def data_of(path: Path) -> list[Any]:
    """Return the data of a page; a number that JSON does not have fails the test."""
    scripts = read(path).scripts
    return [json.loads(text, parse_constant=pytest.fail) for kind, text in scripts if kind == "application/json"]
