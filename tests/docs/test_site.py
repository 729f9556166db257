"""Parts that make the docs site: formulas without scripts, places that are filled, pages that load nothing from elsewhere."""

import re
from pathlib import Path

import pytest
from docutils import nodes

from docs import conf
from docs.extensions import filled, formulas, no_request

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs").glob("*.md"))


def test_all_pages_are_reached_from_the_first() -> None:
    assert {page.name for page in ROOT.glob("*.md")} == {name for name in conf.include_patterns if "/" not in name}
    first = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    trees = re.findall(r"^```\{toctree\}\n(.*?)^```$", first, re.DOTALL | re.MULTILINE)
    lines = {line for tree in trees for line in tree.splitlines() if line and not line.startswith(":")}
    listed = {re.sub(r".* <(.*)>", r"\1", line) for line in lines}
    top = {f"../{page.stem}" for page in ROOT.glob("*.md")}
    assert listed == top | {page.stem for page in PAGES} - {"index"}


def latex() -> list[tuple[str, bool]]:
    """Return all formulas of all pages, and whether they are on lines of their own."""
    found = []
    for page in PAGES:
        text = re.sub(r"^```.*?^```$|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
        found += [(one, True) for one in re.findall(r"\$\$(.*?)\$\$", text, re.DOTALL)]
        found += [(one, False) for one in re.findall(r"\$([^$\n]+)\$", re.sub(r"\$\$.*?\$\$", "", text, flags=re.DOTALL))]
    return found


def test_every_formula_becomes_mathml() -> None:
    assert len(latex()) > 15
    for text, is_block in latex():
        written = formulas.mathml(text, is_block=is_block)
        assert written.startswith("<math") and written.endswith("</math>")
        assert ('display="block"' in written) == is_block and "merror" not in written


def test_a_formula_that_is_none_is_shown_as_it_is_and_warned_of(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[tuple[object, ...]] = []
    monkeypatch.setattr(formulas.LOG, "warning", lambda *words, location: said.append(words))
    node = nodes.math("", r"\nonsense{<")
    assert formulas.written(node, is_block=False) == r"<code>\nonsense{&lt;</code>"
    assert len(said) == 1 and said[0][1] == r"\nonsense{<"


def test_the_first_example_is_the_one_of_the_readme() -> None:
    example = filled.filled("before\n<!-- first example -->\nafter <!-- first example -->\n")
    assert example.startswith("before\n```python\n") and example.endswith("\n```\nafter <!-- first example -->\n")
    assert example.removeprefix("before\n").partition("\nafter")[0] in (ROOT / "README.md").read_text(encoding="utf-8")


def test_a_link_to_a_folder_is_its_words() -> None:
    text = "[`docs`](../docs) [docs](../docs/) [page](../docs/index.md) ![picture](../docs) [gone](../gone) [there](https://there/)"
    found = filled.without_folders(text, ROOT / "docs")
    assert found == "`docs` docs" + text.partition("(../docs/)")[2]


ELSEWHERE = [
    '<script src="https://there/a.js"></script>', '<link rel="stylesheet" href="//there/a.css">', '<img src="http://there/a.png">',
    '<link rel="preconnect" href="https://there">', '<p style="background: url(https://there/a.png)">', '<object data="https://there/a">',
    "<style>@import 'https://there/a.css';</style>", "<style>@font-face{src:url(https://there/a.woff)}</style>",
    '<img srcset="https://there/a.png 2x" src="a.png">', '<meta http-equiv="refresh" content="0; url=https://there/">',
    '<svg><image href="https://there/a.png"/></svg>', '<video poster="https://there/a.png"></video>',
]
HERE = [
    '<a href="https://there/">there</a>', '<script src="_static/a.js"></script>', '<img src="data:image/png;base64,AAAA">',
    '<link rel="next" href="https://there/">', "<style>a{background:url(a.png)}</style>", "<p>@import https://there</p>",
    '<meta http-equiv="refresh" content="0; url=docs/index.html">', '<math xmlns="http://www.w3.org/1998/Math/MathML"></math>',
]


@pytest.mark.parametrize("page", ELSEWHERE)
def test_what_a_page_loads_from_elsewhere_is_found(page: str) -> None:
    assert len(no_request.from_page(page)) == 1 and "there" in no_request.from_page(page)[0]


@pytest.mark.parametrize("page", HERE)
def test_what_is_here_and_what_is_only_linked_is_fine(page: str) -> None:
    assert no_request.from_page(page) == []


def test_all_files_of_a_site_are_looked_at(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "a.html").write_text(ELSEWHERE[0], encoding="utf-8")
    (tmp_path / "b.css").write_text("a { background: url('https://there/b.png') }", encoding="utf-8")
    (tmp_path / "c.html").write_text(HERE[0], encoding="utf-8")
    assert no_request.from_site(tmp_path) == ["b.css: https://there/b.png", "deep/a.html: https://there/a.js"]
