"""Messages name the thing, the value and what is valid; of very many names those that were probably meant."""

from avatarsim.errors import ALL_NAMED, NEAREST, UnknownName, likely
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
