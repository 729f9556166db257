"""What docstrings, comments and pages name in backticks is there: identifiers, dotted names of modules and their parts, files."""

import io
import re
import tokenize
from functools import cache
from pathlib import Path

Parts = tuple[list[tuple[int, str]], frozenset[str]]

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("avatarsim", "docs", "examples", "reference", "reports", "runfiles", "scenarios", "tests")
FILES = [file for room in ROOMS for file in sorted((ROOT / room).rglob("*.py"))]
PAGES = [page for page in (*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md"))) if page.name != "CHANGELOG.md"]
FOLDERS = ("", "avatarsim", "reference", "reports", "scenarios")
"""Where a file or a module may be counted from, beside the folder of the file that names it."""
SPAN = re.compile(r"(`+)([^`]+?)\1")
IDENTIFIER, FILE = re.compile(r"[A-Za-z_]\w*"), re.compile(r"(?:[\w.-]+/)*[\w-]+\.(?:py|toml|css|js)")
DOTTED = re.compile(r"[A-Za-z_]\w*(?:\.(?!(?:json|csv|npz|html|md)$)[A-Za-z_]\w*)+(?=\(\)$|$)")
ELSEWHERE = {
    "lShldr", "L_Thigh", "nohup", "reserve", "AVTS", "AVPO", "XrQuaternionf", "_optical", "_ned", "is_pressed",
    "avatarsim.engines", "links_31_contact", "avatars_10_apart", "restitution_sphere_240", "friction_box_flat_1000",
}
"""Names in files and programs of others, first bytes of messages, a group of entry points, an example of a name, and names that
are put together."""
OBJECTS = {"engine", "model", "reference", "scene"}
"""Names of folders or modules that are also those of what a user holds: `scene.names` is an attribute."""


def parts(text: str) -> Parts:
    """Of a source: (first line, text) of every comment and of every text that is a statement of its own; and every word of its
    code and of its other texts."""
    prose: list[tuple[int, str]] = []
    words: set[str] = set()
    begins = True
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and begins):
            prose.append((token.start[0], token.string))
        elif token.type in (tokenize.NAME, tokenize.STRING):
            words.update(re.findall(r"\w+", token.string))
        if token.type not in (tokenize.COMMENT, tokenize.NL):
            begins = token.type in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENCODING)
    return prose, frozenset(words)


@cache
def read(file: Path) -> Parts:
    """`parts` of a source file; a page is prose but for its fenced blocks."""
    text = file.read_text(encoding="utf-8")
    if file.suffix == ".py":
        return parts(text)
    return [(1, re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE))], frozenset()


@cache
def all_words() -> frozenset[str]:
    """Those of all files but this one, and the names of files and folders."""
    spoken = (read(file)[1] for file in FILES if file.name != Path(__file__).name)
    return frozenset().union(*spoken, *(file.relative_to(ROOT).with_suffix("").parts for file in FILES))


def leads(place: Path, names: list[str]) -> bool:
    """Whether modules below `place` lead along `names`, and the last of them has the next name among its words."""
    for k, name in enumerate(names):
        if (place / name).is_dir():
            place = place / name
        elif (place / f"{name}.py").is_file():
            return k + 1 == len(names) or names[k + 1] in read(place / f"{name}.py")[1]
        else:
            return (place / "__init__.py").is_file() and name in read(place / "__init__.py")[1]
    return True


def is_there(span: str, file: Path) -> bool:
    """Whether what a file names exists; what is no identifier, dotted name or name of a source file is not looked at."""
    if FILE.fullmatch(span):
        places = [*(ROOT / folder / span for folder in FOLDERS), file.parent / span]
        return any(place.exists() for place in places) or any(other.as_posix().endswith(f"/{span}") for other in FILES)
    known = all_words() | ELSEWHERE
    if IDENTIFIER.fullmatch(span) or span in known:
        return span in known
    if dotted := DOTTED.match(span):
        names = dotted[0].split(".")
        if not set(names) <= known or names[0] in OBJECTS:
            return set(names) <= known
        tops = [top for top in (*(ROOT / folder for folder in FOLDERS), file.parent)
                if (top / names[0]).is_dir() or (top / f"{names[0]}.py").is_file()]
        return not tops or any(leads(top, names) for top in tops)
    return True


def broken(file: Path) -> list[str]:
    """What a file names that is not there."""
    spans = [(line, " ".join(span[2].split())) for line, said in read(file)[0] for span in SPAN.finditer(said)]
    return [f"{file.relative_to(ROOT) if file.is_relative_to(ROOT) else file.name}:{line}: {span}"
            for line, span in spans if not is_there(span, file)]


def test_what_prose_names_is_there() -> None:
    assert [one for file in (*FILES, *PAGES) for one in broken(file)] == []


def test_what_is_not_there_is_found(tmp_path: Path) -> None:
    file = tmp_path / "some.py"
    file.write_text(
        '"""`frame_of_nothing`, ``advance`` and `rigid.impacts` of `avatarsim/frame.py`; `rigid.no_such`."""\n'
        'x = 1\n"""`scene.scene.Scene.names`, `ik.solve.gone_there`, `Scene.gone_too()`, `scene.names`."""\n'
        "# `solve.py`, `not a name`, `gone_for_good.py`\n",
        encoding="utf-8",
    )
    gone = ["frame_of_nothing", "rigid.no_such", "ik.solve.gone_there", "Scene.gone_too()", "gone_for_good.py"]
    assert [one.split(": ")[1] for one in broken(file)] == gone
