"""Source files and dotted names in backticks, in docstrings and comments, lead to something that exists."""

import io
import re
import tokenize
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("avatarsim", "benchmarks", "docs", "examples", "reference", "reports", "runfiles", "scenarios", "tests")
FILES = [file for room in ROOMS for file in sorted((ROOT / room).rglob("*.py"))]
FOLDERS = ("", "avatarsim", "benchmarks", "reference", "reports", "scenarios")
"""Folders from which a file or a module may be named, beside that of the file that names it."""
SPAN = re.compile(r"(`+)([^`]+?)\1")
FILE = re.compile(r"(?:[\w.-]+/)*[\w-]+\.(?:py|toml|css|js)")
DOTTED = re.compile(r"[A-Za-z_]\w*(?:\.(?!(?:json|csv|npz|html|md)$)[A-Za-z_]\w*)+(?=\(\)$|$)")
GROUP = "avatarsim.engines"
"""Of entry points, and no module."""
OBJECTS = {"engine", "model", "reference", "scene"}
"""Names of folders or modules that are also names of objects: `scene.names` is an attribute."""


def prose(text: str) -> list[tuple[int, str]]:
    """(first line, text) of every comment and of every string that is a statement of its own."""
    found = []
    begins = True
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and begins):
            found.append((token.start[0], token.string))
        if token.type not in (tokenize.COMMENT, tokenize.NL):
            begins = token.type in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENCODING)
    return found


@cache
def words(file: Path) -> frozenset[str]:
    return frozenset(re.findall(r"\w+", file.read_text(encoding="utf-8")))


def leads(place: Path, names: list[str]) -> bool:
    """Report whether modules below `place` lead along `names`, and the last of them has the next name among its words."""
    for k, name in enumerate(names):
        if (place / name).is_dir():
            place = place / name
        elif (place / f"{name}.py").is_file():
            return k + 1 == len(names) or names[k + 1] in words(place / f"{name}.py")
        else:
            return (place / "__init__.py").is_file() and name in words(place / "__init__.py")
    return True


def exists(span: str, file: Path) -> bool:
    """Report whether a source file or dotted name exists; other spans are skipped."""
    if FILE.fullmatch(span):
        places = [*(ROOT / folder / span for folder in FOLDERS), file.parent / span]
        return any(place.exists() for place in places) or any(other.as_posix().endswith(f"/{span}") for other in FILES)
    dotted = DOTTED.match(span)
    names = dotted[0].split(".") if dotted else [""]
    if not dotted or names[0] in OBJECTS or dotted[0] == GROUP:
        return True
    tops = [top for top in (*(ROOT / folder for folder in FOLDERS), file.parent)
            if (top / names[0]).is_dir() or (top / f"{names[0]}.py").is_file()]
    return not tops or any(leads(top, names) for top in tops)


def broken(file: Path) -> list[str]:
    spans = [(line, " ".join(span[2].split())) for line, text in prose(file.read_text(encoding="utf-8"))
             for span in SPAN.finditer(text)]
    return [f"{file.name}:{line}: {span}" for line, span in spans if not exists(span, file)]


def test_files_and_dotted_names_in_prose_exist() -> None:
    assert [one for file in FILES if file != Path(__file__) for one in broken(file)] == []


def test_missing_ones_are_found(tmp_path: Path) -> None:
    file = tmp_path / "some.py"
    text = '"""`rigid.impacts` of `avatarsim/frame.py`; `rigid.no_such`."""\nx = 1\n# `gone_for_good.py`\n'
    file.write_text(text, encoding="utf-8")
    assert [one.split(": ")[1] for one in broken(file)] == ["rigid.no_such", "gone_for_good.py"]
