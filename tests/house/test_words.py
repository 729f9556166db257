"""Prose of the whole project, code and pages, names bodies, links, engines, users; modules open with a sentence."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ENGINE = ROOT / "avatarsim"
FILES = sorted(ENGINE.rglob("*.py"))
ROOMS = (".setup", "docs", "examples", "reference", "reports", "runfiles", "scenarios", "tests")
"""Folders beside the engine whose prose is held to the same words."""
OUTPUTS = ROOT / "reports" / "out"
"""Where commands write."""


def sources(folder: Path, pattern: str) -> list[Path]:
    """Files below a folder, in order, without what commands wrote."""
    return [file for file in sorted(folder.rglob(pattern)) if OUTPUTS not in file.parents]


PAGES = [*sorted(ROOT.glob("*.md")), *sources(ROOT / "docs", "*.md")]
OPENED = [*FILES, *(file for room in ROOMS for file in sources(ROOT / room, "*.py"))]
"""Modules that open with a sentence."""
ENDINGS = {".toml", ".j2", ".html", ".js", ".css", ".yml"}
TEXTS = [
    *(ROOT / name for name in ("Makefile", "pyproject.toml", ".pre-commit-config.yaml", ".ci/run")),
    *(file for room in ("avatarsim", ".github", *ROOMS) for file in sources(ROOT / room, "*") if file.suffix in ENDINGS),
]
"""Settings, templates and scripts: held to the same words as a whole, for they use none of them as names."""

PERSONS = re.compile(r"\b(who|whom|whoever|(no|some|every|any)body|(some|every|any)one|strangers?)\b", re.IGNORECASE)
"""Subjects of which a reader cannot tell whether a body, a link, an avatar, a process or a user is meant."""

SENTENCE = re.compile(r"[A-Z0-9`\"(]\S*( \S+){2,}[.?]")
"""At least three words, the first with a capital, up to a full stop or a question mark."""


def prose(text: str) -> Iterator[tuple[int, str]]:
    """(line, text) of every docstring, those after constants and fields included, and of every comment."""
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            yield from enumerate(lines[node.lineno - 1 : node.end_lineno], node.lineno)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string


def persons_in(text: str) -> list[str]:
    """Lines of prose with such a subject."""
    return [f"{line}: {said.strip()}" for line, said in prose(text) if PERSONS.search(said)]


def persons_on(page: str) -> list[str]:
    """Lines of a page with such a subject; what stands in a block of code is none."""
    words = re.sub(r"^```.*?^```$", lambda block: "\n" * block[0].count("\n"), page, flags=re.DOTALL | re.MULTILINE)
    return [f"{line}: {said}" for line, said in enumerate(words.splitlines(), 1) if PERSONS.search(said)]


def opens_with_a_sentence(text: str) -> bool:
    """Whether the module's docstring begins with one."""
    said = ast.get_docstring(ast.parse(text)) or ""
    return SENTENCE.match(" ".join(said.split())) is not None


@pytest.mark.parametrize("file", FILES, ids=[str(file.relative_to(ENGINE)) for file in FILES])
def test_prose_has_no_persons_for_subjects(file: Path) -> None:
    assert persons_in(file.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("room", ROOMS)
def test_prose_beside_the_engine_has_none_either(room: str) -> None:
    files = sources(ROOT / room, "*.py")
    assert files
    found = {str(file.relative_to(ROOT)): persons_in(file.read_text(encoding="utf-8")) for file in files}
    assert {name: lines for name, lines in found.items() if lines} == {}


@pytest.mark.parametrize("page", PAGES, ids=[str(page.relative_to(ROOT)) for page in PAGES])
def test_pages_have_no_persons_for_subjects(page: Path) -> None:
    assert persons_on(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("file", TEXTS, ids=[str(file.relative_to(ROOT)) for file in TEXTS])
def test_settings_templates_and_scripts_have_none(file: Path) -> None:
    assert not PERSONS.search(file.read_text(encoding="utf-8"))


@pytest.mark.parametrize("file", OPENED, ids=[str(file.relative_to(ROOT)) for file in OPENED])
def test_modules_open_with_a_sentence(file: Path) -> None:
    assert opens_with_a_sentence(file.read_text(encoding="utf-8"))


def test_prose_is_docstrings_and_comments_and_no_code() -> None:
    text = 'NOBODY = 1  # Who.\n"""Of\nwhoever."""\n\ndef who(whom: str = "anybody") -> None:\n    """Somebody\'s."""\n'
    assert persons_in(text) == ["3: whoever.\"\"\"", "6: \"\"\"Somebody's.\"\"\"", "1: # Who."]
    assert persons_in('"""Whose body, in whole: somebody_else, anybodies."""\n') == []


def test_pages_are_read_without_their_blocks_of_code() -> None:
    assert persons_on("Whose.\n```sh\nUSER nobody\n```\nA body who\nmoves.\n") == ["5: A body who"]


@pytest.mark.parametrize("text", ["", '"""Bodies."""', '"""bodies that move."""', '"""Bodies that move"""', "X = 1\n"])
def test_less_than_a_sentence_is_none(text: str) -> None:
    assert not opens_with_a_sentence(text)
    assert opens_with_a_sentence('"""Islands: bodies that\nmay meet. And more."""\n')
