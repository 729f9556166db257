"""Docstrings of public names become reStructuredText that says the same, without a complaint of docutils."""

import inspect

import docutils.core
import docutils.nodes
import pytest

from docs.extensions.docstrings import restructured
from docs.extensions.public_names import Public, assigned, directive, page, public_names, signature_of


def parsed(lines: list[str]) -> docutils.nodes.document:
    """The document of some reStructuredText; any complaint is an error."""
    return docutils.core.publish_doctree("\n".join(lines), settings_overrides={"report_level": 1, "halt_level": 1})


def docstrings(public: Public) -> list[str]:
    """Those of a name and of its members."""
    found = [assigned(public.home).get(public.short)]
    if isinstance(public.found, type) or inspect.isroutine(public.found):
        # any other object has the docstring of its type
        found.append(inspect.getdoc(public.found))
    if isinstance(public.found, type):
        found += [inspect.getdoc(member) for name, member in vars(public.found).items() if not name.startswith("_")]
    return [text for text in found if text]


@pytest.mark.parametrize("public", public_names(), ids=lambda public: public.dotted)
def test_docstrings_of_public_names_are_understood(public: Public) -> None:
    said = docstrings(public)
    assert said, "a public name without a docstring"
    for text in said:
        words = parsed(restructured(text.splitlines())).astext()
        assert "".join(words.split()) == "".join(text.replace("`", "").replace("Returns:", "Returns").split()).replace("\n- ", "")


TABLE = "Posture of all.\n\nname    [m] what `it` is\n        and more\nother_  x* |y|\n"


def test_a_table_is_a_definition_list() -> None:
    document = parsed(restructured(TABLE.splitlines()))
    items = list(document.findall(docutils.nodes.definition_list_item))
    assert [item.children[0].astext() for item in items] == ["name", "other_"]
    assert [item.children[-1].astext() for item in items] == ["[m] what it is and more", "x* |y|"]
    assert [one.astext() for one in document.findall(docutils.nodes.literal)] == ["name", "it", "other_"]


SECTIONS = "Do it.\n\nArgs:\n    one: what it is,\n        at length.\n    two: the other.\n\nReturns:\n    (a, b): both.\n"


def test_sections_have_their_names_and_rows() -> None:
    document = parsed(restructured(SECTIONS.splitlines()))
    assert [one.astext() for one in document.findall(docutils.nodes.strong)] == ["Args", "Returns"]
    assert [one.children[0].astext() for one in document.findall(docutils.nodes.definition_list_item)] == ["one", "two"]


@pytest.mark.parametrize("text", [
    "Eq. (4): p' = p - (a_h . (p - o_h)) a_h, with a_ and |x| and *y* and [1]_ and ::", "- one entry\nand a line", "1. no list",
    ".. no: directive", "`name`s and x`name`y, ``both`` of <them>", "back\\slash and :role:`text`", ">>> no session",
    "a\n    b\n  c",
])
def test_what_looks_like_markup_is_none(text: str) -> None:
    words = parsed(restructured(text.splitlines())).astext()
    assert "".join(words.split()) == "".join(text.replace("`", "").removeprefix("- ").split())


def test_every_name_has_one_directive_on_the_page() -> None:
    lines = list(page())
    names = public_names()
    assert len({public.dotted for public in names}) == len(names) > 25
    for public in names:
        assert lines.count(directive(public)[0]) == 1


def example(one: int, *rest: "float", keyed: tuple[int, ...] = (1, 2)) -> "dict[str, int]":
    """A function."""
    return {}


def test_signatures_stand_as_they_do_in_the_source() -> None:
    assert signature_of(example, False) == ("(one: int, *rest: float, keyed: tuple[int, ...]=(1, 2))", "dict[str, int]")
    by_name = {public.short: public.found for public in public_names()}
    scene, _ = signature_of(by_name["Scene"], False)
    assert "materials: PairTable = TABLE_1" in scene and scene.startswith("(name: str, bodies: tuple[Body, ...] = ()")
    assert "start: TrackerSample | None = None" in scene
    assert signature_of(by_name["UnknownName"], False)[0] == "(thing: str, value: str, known: Iterable[str])"
    assert signature_of(by_name["Role"], False) == ("", None)
