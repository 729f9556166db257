"""CHANGELOG.md is in the form of Keep a Changelog, with one fact on one line, and its newest version is the package's."""

import re
from pathlib import Path

from avatarsim.version import VERSION

TEXT = (Path(__file__).parents[2] / "CHANGELOG.md").read_text(encoding="utf-8")
GROUPS = ("Added", "Changed", "Deprecated", "Removed", "Fixed", "Security")
"""Of Keep a Changelog, in its order."""
WIDTH = 130
"""Most characters of a line."""


def test_the_newest_version_is_the_package_s_and_unreleased_stands_on_top() -> None:
    titles = re.findall(r"^## (.*)$", TEXT, re.MULTILINE)
    assert titles[0] == "[Unreleased]"
    released = [re.fullmatch(r"\[(\d+)\.(\d+)\.(\d+)\] - \d{4}-\d\d-\d\d", title) for title in titles[1:]]
    assert released and all(released)
    numbers = [tuple(map(int, found.groups())) for found in released if found]
    assert numbers == sorted(set(numbers), reverse=True)
    assert VERSION == ".".join(map(str, numbers[0]))


def test_groups_are_those_of_the_form_and_none_is_empty() -> None:
    for part in re.split(r"^## ", TEXT, flags=re.MULTILINE)[1:]:
        groups = re.findall(r"^### (.*)$", part, re.MULTILINE)
        assert groups == [group for group in GROUPS if group in groups]
        assert all(re.search(r"^- ", group, re.MULTILINE) for group in re.split(r"^### ", part, flags=re.MULTILINE)[1:])


def test_each_fact_is_one_line() -> None:
    # between the title of a version and its first group there may be a paragraph
    groups = re.findall(r"^### .*\n((?:(?!#{2,3} ).*\n)*)", TEXT, re.MULTILINE)
    entries = [line for group in groups for line in group.splitlines()]
    assert len(entries) > 50
    for line in entries:
        assert len(line) <= WIDTH and re.match(r"- \S.*[^.]\.$|$", line), line
