"""A file that holds what no command writes costs its section and is named; what raises anything else is a fault of ours."""

import pytest

from reports.extra_sections import UNDRAWABLE, made


def test_a_section_is_what_was_kept_and_what_is_made_of_it() -> None:
    damage: list[str] = []
    assert made("judge", (1, 2), lambda kept: {"judge_sum": sum(kept)}, damage) == {"judge": (1, 2), "judge_sum": 3}
    assert made("judge", None, lambda kept: {"judge_sum": 0}, damage) == {"judge": None} and damage == []


@pytest.mark.parametrize("kind", [KeyError, OverflowError, TypeError, IndexError])
def test_what_cannot_be_made_is_said_and_left_out(kind: type[Exception]) -> None:
    def section(kept: int) -> object:
        raise kind("mode")

    damage: list[str] = []
    assert issubclass(kind, UNDRAWABLE) and made("narrow", 1, section, damage) == {"narrow": None}
    assert len(damage) == 1 and "narrow" in damage[0] and kind.__name__ in damage[0]


def test_a_missing_package_is_no_damage() -> None:
    def section(kept: int) -> object:
        raise ImportError("altair")

    with pytest.raises(ImportError):
        made("narrow", 1, section, [])
