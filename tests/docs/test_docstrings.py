"""Docstrings of public names become reStructuredText without a complaint of docutils."""

import inspect

import docutils.core
import docutils.nodes
import pytest

from docs.extensions.docstrings import restructured
from docs.extensions.public_names import Public, assigned, public_names


def parsed(lines: list[str]) -> docutils.nodes.document:
    """Return the document of some reStructuredText; any complaint is an error."""
    return docutils.core.publish_doctree("\n".join(lines), settings_overrides={"report_level": 1, "halt_level": 1})


def docstrings(public: Public) -> list[str]:
    """Return the docstrings of a name and of its members."""
    found = [assigned(public.home).get(public.short)]
    if isinstance(public.obj, type) or inspect.isroutine(public.obj):
        # any other object has the docstring of its type
        found.append(inspect.getdoc(public.obj))
    if isinstance(public.obj, type):
        found += [inspect.getdoc(member) for name, member in vars(public.obj).items() if not name.startswith("_")]
    return [text for text in found if text]


@pytest.mark.parametrize("public", public_names(), ids=lambda public: public.dotted)
def test_docstrings_of_public_names_are_understood(public: Public) -> None:
    said = docstrings(public)
    assert said, "a public name without a docstring"
    for text in said:
        assert parsed(restructured(text.splitlines())).astext()


@pytest.mark.parametrize("text", [
    "Eq. (4): p' = p - (a_h . (p - o_h)) a_h, with a_ and |x| and *y* and [1]_ and ::", "- one entry\nand a line", "1. no list",
    ".. no: directive", "`name`s and x`name`y, ``both`` of <them>", "back\\slash and :role:`text`", ">>> no session",
    "a\n    b\n  c",
])
def test_what_looks_like_markup_is_none(text: str) -> None:
    words = parsed(restructured(text.splitlines())).astext()
    assert "".join(words.split()) == "".join(text.replace("`", "").removeprefix("- ").split())
