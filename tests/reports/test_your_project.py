"""What the page answers to a project that would use the engine is true of this source."""

import tomllib
from pathlib import Path

from avatarsim.scene.body import Role
from reports.your_project import ANSWERS, NO, PARTLY, UNMEASURED, YES
from scenarios.growth.worlds import AVATARS

ROOT = Path(__file__).resolve().parents[2]


def fact(question: str) -> str:
    (found,) = [one for one in ANSWERS if one.question.startswith(question)]
    return found.facts


def test_every_answer_is_one_of_the_words_and_has_its_facts() -> None:
    assert all(one.word in (YES, NO, PARTLY, UNMEASURED) and one.facts.endswith(".") for one in ANSWERS)
    assert len({one.question for one in ANSWERS}) == len(ANSWERS)


def test_licence_numbers_and_kinds_of_bodies_are_those_of_the_source() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["license"] in fact("Licence")
    assert f"up to {max(AVATARS)}." in fact("Several avatars")
    assert {role.name for role in Role} == {"FIXED", "SIMULATED", "DRIVEN"}, "another kind would make the second answer false"


def test_no_kernel_runs_on_several_threads() -> None:
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "avatarsim").rglob("*.py"))
    assert not any(word in sources for word in ("parallel=True", "prange", "ThreadPool"))
    assert "the thread that asks" in fact("Several threads")
