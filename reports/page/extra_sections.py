"""Sections of the page that are made of files of their own: each is made and rendered by itself, so that a file that holds what
no command writes costs its section alone, and is named."""

from collections.abc import Callable, Mapping, MutableSequence, Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from jinja2 import UndefinedError

from reports.words.wording import listed

UNDRAWABLE = (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, UndefinedError, ValueError)
"""What is raised over a file that is whole and holds what no run writes: a shape of an unknown kind, figures without numbers,
lists of another length, objects in objects without end."""

Kept = TypeVar("Kept")
Made = TypeVar("Made")
Names = Mapping[str, object]


@dataclass(frozen=True)
class Section(Generic[Kept]):
    """One section. `kept`: what the run has for it, which its `template` knows by `name`, None for nothing; `files`: where that
    comes from; `made`: what else the template needs then, and `otherwise`: what it needs without."""

    name: str
    template: str
    files: tuple[str, ...]
    kept: Kept | None
    made: Callable[[Kept], Names]
    otherwise: Callable[[], Names] = dict


def drawn(
    sections: Sequence[Section[Any]], render: Callable[[str, Names], str], damage: MutableSequence[str],
    before: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, str]:
    """The text of each section by its name, as `render` makes it of a template and names; a template finds the sections before
    its own under `drawn`, and `before`. Of one that cannot be drawn what stands without its files; why goes to `damage`."""
    texts = dict(before)
    for section in sections:
        begun = partial(render, section.template)
        text = tried(section.files, partial(_whole, section, begun, texts), damage) if section.kept else None
        if text is None:
            text = begun({"drawn": texts, section.name: None, **section.otherwise()})
        texts[section.name] = text
    return texts


def _whole(section: Section[Kept], render: Callable[[Names], str], before: Names) -> str:
    assert section.kept is not None
    return render({"drawn": before, section.name: section.kept, **section.made(section.kept)})


def tried(files: tuple[str, ...], made: Callable[[], Made], damage: MutableSequence[str]) -> Made | None:
    """What is made of `files`; None if they hold what no command writes, and a sentence on that, once, to `damage`."""
    try:
        return made()
    except UNDRAWABLE as error:
        said = f"{listed(files)}: what it holds cannot be drawn ({type(error).__name__}: {error})"
        if said not in damage:
            damage.append(said)
        return None
