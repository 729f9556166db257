"""Effects: narrowed by name, and what was taken away is said."""

import pytest

from avatarsim.errors import InvalidScene
from avatarsim.scene.effects import Effects


def test_narrowing_switches_off_what_is_named_and_nothing_else() -> None:
    less = Effects().narrowed("friction", "sleeping")
    assert not less.friction and not less.sleeping and less.restitution and less.overlap_removal


def test_narrowing_by_nothing_changes_nothing() -> None:
    assert Effects().narrowed() == Effects()


def test_an_unknown_effect_is_named_and_the_known_ones_listed() -> None:
    with pytest.raises(InvalidScene) as error:
        Effects().narrowed("fricton")
    assert "'fricton'" in str(error.value) and "friction" in str(error.value)


def test_what_an_author_took_away_is_listed() -> None:
    derived = Effects(friction=False)
    assert derived.narrowed("friction", "sleeping").missing_from(derived) == ("sleeping",)


@pytest.mark.parametrize("value", [0, 1.0, "yes", None, ()])
def test_a_switch_is_true_or_false(value: object) -> None:
    with pytest.raises(InvalidScene, match="effect friction is .*True or False"):
        Effects(friction=value)  # type: ignore[arg-type]
