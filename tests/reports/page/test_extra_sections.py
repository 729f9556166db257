"""A file that holds what no command writes costs its section and is named, wherever it is noticed; what raises anything else is a
fault of ours."""

from collections.abc import Mapping
from pathlib import Path

import pytest
from jinja2 import DictLoader, Environment, StrictUndefined

from reports import write_report
from reports.page import index as pages
from reports.page.extra_sections import Section, drawn
from tests.hostile import valid_files

TEMPLATES = {
    "pairs": "{% if pairs %}{% for first, second in pairs %}{{ first }}<{{ second }} {% endfor %}"
             "sum {{ total }}{% else %}none{% endif %}",
    "named": "{% if named %}{{ named.name }} after {{ drawn.pairs }}{% endif %}",
}
Pairs = tuple[tuple[int, ...], ...]


def render(template: str, names: Mapping[str, object]) -> str:
    return Environment(loader=DictLoader(TEMPLATES), undefined=StrictUndefined).get_template(template).render(names)


def pairs(kept: Pairs | None) -> Section[Pairs]:
    return Section("pairs", "pairs", ("pairs.json", "more.csv"), kept, lambda found: {"total": sum(map(sum, found))})


def test_a_section_is_what_was_kept_and_what_is_made_of_it() -> None:
    damage: list[str] = []
    named = Section("named", "named", ("named.json",), {"name": "it"}, lambda kept: {})
    assert drawn((pairs(((1, 2), (3, 4))), named), render, damage) == {
        "pairs": "1<2 3<4 sum 10", "named": "it after 1<2 3<4 sum 10"}
    assert drawn((pairs(None),), render, damage) == {"pairs": "none"} and damage == []


def test_what_stands_without_a_file_may_need_names_of_its_own() -> None:
    total = Section("total", "total", (), None, lambda kept: {"said": kept}, lambda: {"said": "nothing"})
    assert drawn((total,), lambda template, names: f"{template} {names['said']}", []) == {"total": "total nothing"}


@pytest.mark.parametrize("kept", [((1, 2), (3,)), ((1, 2, 3),), ((1, "x"),), 7])
def test_what_cannot_be_rendered_is_said_with_its_files_and_left_out(kept: Pairs) -> None:
    damage: list[str] = []
    good = Section("named", "named", ("named.json",), {"name": "it"}, lambda kept: {})
    found = drawn((pairs(kept), good, Section("named", "named", ("odd.json",), {"nome": "it"}, lambda kept: {})), render, damage)
    assert found["pairs"] == "none" and found["named"] == ""
    assert [said.partition(":")[0] for said in damage] == ["pairs.json, more.csv", "odd.json"]


@pytest.mark.parametrize("kind", [KeyError, OverflowError, TypeError, IndexError, RecursionError])
def test_what_cannot_be_made_is_said_once(kind: type[Exception]) -> None:
    def made(kept: Pairs) -> Mapping[str, object]:
        raise kind("mode")

    damage: list[str] = []
    broken = Section("pairs", "pairs", ("pairs.json",), ((1, 2),), made)
    assert drawn((broken, broken), render, damage) == {"pairs": "none"}
    assert len(damage) == 1 and damage[0].startswith("pairs.json: ") and kind.__name__ in damage[0]


def test_a_missing_package_is_no_damage() -> None:
    def made(kept: Pairs) -> Mapping[str, object]:
        raise ImportError("altair")

    with pytest.raises(ImportError):
        drawn((Section("pairs", "pairs", (), ((1, 2),), made),), render, [])


def test_every_section_is_guarded_where_it_is_rendered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, content in valid_files.run().items():
        (tmp_path / name).write_bytes(content)
    assert write_report(tmp_path) == ()
    whole = (tmp_path / "index.html").read_text(encoding="utf-8")
    found, really = list[Section[object]](), pages._rendered

    def fails(template: str, names: Mapping[str, object]) -> str:
        if any(names.get(section.name) is not None and section.template == template for section in found):
            raise ValueError("not enough values to unpack")
        return really(template, names)

    listing = pages._sections
    monkeypatch.setattr(pages, "_sections", lambda *parts: found.extend(listing(*parts)) or tuple(found))
    monkeypatch.setattr(pages, "_rendered", fails)
    damage = write_report(tmp_path)
    assert len(found) == len(damage) == 12
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    for section, said in zip(found, damage, strict=True):
        assert section.kept is not None and section.files and all(name in valid_files.run() for name in section.files)
        assert said.startswith(f"{', '.join(section.files)}: ") and f"Left out, since it cannot be used: {said}" in text
    for name in ("queries", "many", "table-2", "growth", "convergence", "sweep", "law-map", "closeness"):
        assert f'id="{name}"' in whole and f'id="{name}"' not in text
    assert "Ranking</h2>" in text and 'id="paper"' in text
