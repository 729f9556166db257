"""Docstrings of this project, which are plain text, as reStructuredText for autodoc.

Marks of plain text keep their meaning: paragraphs, names in backticks, tables of `name  meaning`, sections such as `Returns:`,
lists with hyphens, indented blocks. Everything else that reStructuredText would take for markup is escaped.
"""

import re
from collections.abc import Iterable, Iterator

from sphinx.application import Sphinx

ENTRY = re.compile(r"(\w+(?:, \w+)*) {2,}(\S.*)")
"""A row of a table: name, two spaces at least, meaning."""
ARGUMENT = re.compile(r"(\w+(?:, \w+)*): (\S.*)")
"""A row of a section `Args:`."""
SECTION = re.compile(r"(Args|Returns|Raises):")
SPAN = re.compile(r"``([^`]+)``|`([^`]+)`")
MARKUP = re.compile(r"([\\*_|`\[\]:<>])")
Lines = list[str]


def escaped(text: str) -> str:
    """Return plain text in which nothing is markup."""
    return MARKUP.sub(r"\\\1", text)


def inline(text: str) -> str:
    """Return a paragraph: names in backticks as literals, all else escaped, nothing at its begin that would open a list."""
    escaped_text, end = "", 0
    for span in SPAN.finditer(text):
        # markup wants a space or nothing next to it: an escaped space is none when it is shown
        escaped_text += escaped(text[end : span.start()]) + rf"\ ``{(span[1] or span[2]).strip()}``\ "
        end = span.end()
    return rf"\ {escaped_text}{escaped(text[end:])}"


def blocks(lines: Iterable[str]) -> Iterator[Lines]:
    """Runs of lines between empty ones."""
    block: Lines = []
    for line in (*lines, ""):
        if line.strip():
            block.append(line.rstrip())
        elif block:
            yield block
            block = []


def joined(lines: Iterable[str]) -> str:
    """Return lines as one."""
    return " ".join(line.strip() for line in lines)


def indent_of(line: str) -> int:
    """Return spaces at the begin of a line."""
    return len(line) - len(line.lstrip())


def items(block: Lines) -> list[Lines]:
    """Return lines with those below them that are indented farther than the first."""
    least, entries = indent_of(block[0]), list[Lines]()
    for line in block:
        if indent_of(line) <= least or not entries:
            entries.append([line])
        else:
            entries[-1].append(line)
    return entries


def definitions(block: Lines, row: re.Pattern[str]) -> Lines:
    """Return a definition list of rows, all of which match; empty if one does not."""
    rows: Lines = []
    for item in items(block):
        entry = row.fullmatch(item[0].strip())
        if entry is None:
            return []
        rows += [f"``{entry[1]}``", f"    {inline(joined([entry[2], *item[1:]]))}", ""]
    return rows


def section(block: Lines) -> Lines:
    """Return a section: its name, and rows of arguments or a text."""
    name, rest = block[0].strip().removesuffix(":"), block[1:]
    return [f"**{name}**", "", *((rest and definitions(rest, ARGUMENT)) or [inline(joined(rest)), ""])]


def written(block: Lines) -> Lines:
    """Return one block as reStructuredText, with an empty line at its end."""
    if SECTION.fullmatch(block[0].strip()) and len(block) > 1:
        return section(block)
    if rows := definitions(block, ENTRY):
        return rows
    if all(line.startswith("    ") for line in block):
        return ["::", "", *block, ""]
    if block[0].lstrip().startswith("- "):
        return [*(f"- {inline(joined(item).removeprefix('- '))}" for item in items(block)), ""]
    for k, line in enumerate(block[1:], 1):
        # a table, a section or a list right below its sentence
        if ENTRY.fullmatch(line) or SECTION.fullmatch(line) or line.startswith("- "):
            return [inline(joined(block[:k])), "", *written(block[k:])]
    return [inline(joined(block)), ""]


def restructured(lines: Iterable[str]) -> Lines:
    """Return a docstring as reStructuredText."""
    return [line for block in blocks(lines) for line in written(block)]


def process(app: Sphinx, what: str, name: str, obj: object, options: object, lines: Lines) -> None:
    """Called by autodoc with each docstring, whose lines are replaced."""
    lines[:] = restructured(lines)


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
