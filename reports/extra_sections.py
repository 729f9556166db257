"""Sections of the page that are made of a file of their own: a file that holds what no command writes costs its section alone."""

from collections.abc import Callable, MutableSequence
from typing import TypeVar

UNDRAWABLE = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
"""What is raised over a file that is whole and holds what no run writes: a shape of an unknown kind, figures without numbers."""

Kept = TypeVar("Kept")


def made(
    name: str, kept: Kept | None, section: Callable[[Kept], object], damage: MutableSequence[str],
) -> dict[str, object]:
    """What the template needs for the section `name`: what was `kept`, and what `section` makes of it. Without either the name
    alone, as None; why it cannot be made goes to `damage`."""
    if not kept:
        return {name: kept}
    try:
        found = section(kept)
    except UNDRAWABLE as error:
        damage.append(f"the section {name} cannot be made of its file ({type(error).__name__}: {error})")
        return {name: None}
    return {name: kept, **(found if isinstance(found, dict) else {})}
