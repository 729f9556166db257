"""What is added to a finished page: links to all sections, and the headings of cells that become cards on a narrow screen."""

import re
from html import escape, unescape

PLACE = "<!-- links to all sections -->"
"""Stands in the page where the links go."""
SECTION = re.compile(r'<section\b([^>]*)>\s*(?:<h[12][^>]*>(.*?)</h[12]>)?', re.DOTALL)
NAMED = re.compile(r'\b(id|data-nav)="([^"]*)"')
TAG = re.compile(r"<[^>]*>")


def linked(page: str) -> str:
    """The page with a link to every section that has an id: by the section's `data-nav`, else by its heading."""
    links = []
    for attributes, heading in SECTION.findall(page):
        named = dict(NAMED.findall(attributes))
        if "id" in named:
            words = unescape(named.get("data-nav") or TAG.sub("", heading)).strip() or named["id"]
            links.append(f'<a href="#{named["id"]}">{escape(words)}</a>')
    return page.replace(PLACE, " ".join(links), 1)


# scripts are passed over: they may hold the text of a table
TABLE = re.compile(r"<script\b.*?</script>|<table\b.*?</table>", re.DOTALL)
HEAD = re.compile(r"<thead\b.*?</thead>", re.DOTALL)
ROW = re.compile(r"<tr\b.*?</tr>", re.DOTALL)
CELL = re.compile(r"<(t[hd])\b([^>]*)>(.*?)</\1>", re.DOTALL)
SPAN = re.compile(r'\b(row|col)span="(\d+)"')
BREAK = re.compile(r"<small\b.*?</small>|<svg\b.*?</svg>", re.DOTALL)


def labelled(page: str) -> str:
    """The page with a label on every body cell of its tables that have a heading; everything else is left as it is."""
    return TABLE.sub(lambda found: found.group() if found.group().startswith("<script") else _table(found.group()), page)


def _table(text: str) -> str:
    head = HEAD.search(text)
    if head is None:
        return text
    headings: list[str] = []
    for _, attributes, content in CELL.findall(head.group()):
        headings += [_words(content)] * _spans(attributes)[1]
    covered: dict[int, int] = {}

    def row(found: re.Match[str]) -> str:
        column = 0

        def cell(one: re.Match[str]) -> str:
            nonlocal column
            while covered.get(column, 0) > 0:
                column += 1
            down, across = _spans(one[2])
            label = headings[column] if across == 1 and column < len(headings) else ""
            for taken in range(column, column + across):
                covered[taken] = down
            column += across
            said = f' data-label="{escape(label, quote=True)}"' if label else ""
            return f"<{one[1]}{one[2]}{said}>{one[3]}</{one[1]}>"

        made = CELL.sub(cell, found.group())
        for taken in covered:
            covered[taken] -= covered[taken] > 0
        return made

    return text[: head.end()] + ROW.sub(row, text[head.end():])


def _words(content: str) -> str:
    """What a heading says: without the notes beneath it and without pictures."""
    return " ".join(unescape(TAG.sub("", BREAK.sub("", content))).split())


def _spans(attributes: str) -> tuple[int, int]:
    """(rows, columns) that a cell covers."""
    found = {name: int(number) for name, number in SPAN.findall(attributes)}
    return found.get("row", 1), max(1, found.get("col", 1))
