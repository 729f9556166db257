"""The page of state lists all that frames keep."""

import re
from itertools import pairwise
from pathlib import Path

from avatarsim.snapshot import retained_fields
from tests.test_snapshot import cases

PAGE = (Path(__file__).parents[2] / "docs" / "state.md").read_text(encoding="utf-8")
WHOLE = {"poses", "velocities", "posture"}
"""Fields that the page lists as one."""
PARTS = ("World", "Target", "IkLoop", "SimulatedLoop", "PaperLoop")
NAMES = ("a heap", "a path", "thrown about, method paper")
"""Scenes in which together every part occurs."""


def listed() -> dict[str, set[str]]:
    """Return fields that the page has, by part."""
    found = {}
    for text, after in pairwise([*re.finditer(r"^## (\w+)$|\Z", PAGE, re.MULTILINE)]):
        found[text[1]] = set(re.findall(r"^\| `([\w.]+)` \|", PAGE[text.end() : after.start()], re.MULTILINE))
    return found


def test_the_page_lists_what_frames_keep_and_nothing_else() -> None:
    found: dict[str, set[str]] = {part: set() for part in PARTS}
    for name in NAMES:
        for field in retained_fields(cases()[name].engine()._running()):
            part, *names = field.name.split(".")
            found[part].add(names[0] if names[0] in WHOLE else ".".join(names[:2]))
    assert found == listed()
