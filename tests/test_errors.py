"""Messages name the thing, the value and what is valid; of very many names those that were probably meant."""

from avatarsim.errors import ALL_NAMED, LONGEST_VALUE, NEAREST, InvalidInput, UnknownName, likely
from scenarios import catalog

MANY = [f"scene_{k}" for k in range(ALL_NAMED)] + ["two_arms", "two_arms_and_leg"]


def test_few_names_are_all_listed_in_order() -> None:
    assert str(UnknownName("engine", "bulet", ("pybullet", "mujoco"))) == "engine is 'bulet'; valid: one of mujoco, pybullet"
    assert likely("x", MANY[:ALL_NAMED]).count(", ") == ALL_NAMED - 1


def test_of_many_names_the_one_that_was_meant_comes_first() -> None:
    assert likely("two_arm", MANY).startswith("two_arms, ")


def test_names_like_none_give_the_first_few_and_how_many_there_are() -> None:
    said = likely("zzz", MANY)
    assert said.count(", ") == NEAREST - 1 and said.endswith(f" and {len(MANY) - NEAREST} others")


def test_each_scene_is_found_by_its_name_without_a_letter() -> None:
    known = list(catalog.scenarios())
    for name in known:
        assert name in likely(name[:-1], known)


def test_of_a_long_value_a_message_shows_the_beginning_and_the_end() -> None:
    said = str(InvalidInput("corners", list(range(10**5)), "few"))
    assert said.startswith("corners is [0, 1, 2") and said.endswith("99999]; valid: few") and len(said) < 2 * LONGEST_VALUE


def test_a_value_that_cannot_be_shown_is_named_by_its_type() -> None:
    class Shy:
        def __repr__(self) -> str:
            raise RuntimeError

    assert str(InvalidInput("thing", Shy(), "another")) == "thing is a Shy; valid: another"
