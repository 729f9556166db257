"""What the README shows works, and prints what it says; what it does not name is on the page of commands."""

import re
from pathlib import Path

import pytest

from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Sphere
from avatarsim.settings import PostureSettings
from scenarios.__main__ import COMMANDS as HARNESS
from scenarios.run.gate import MEANINGS

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")


def test_the_example_prints_what_its_comment_says_to_the_last_digit(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    ((said, sum_of),) = re.findall(r"^print\(.*\)  # (\[.*\]): (.*)$", code, re.MULTILINE)
    names: dict[str, object] = {}
    exec(code, names)
    assert capsys.readouterr().out == f"{said}\n"
    # the height is what the comment says it is made of, and that is table, fist and the stand-off of the engine
    parts = [float(part) for part in re.findall(r"\d+\.\d+", sum_of)]
    scene, height = names["scene"], float(said.strip("[]").split()[2])
    assert isinstance(scene, Scene)
    thick, fist = scene.bodies[0].pieces[0].shape, scene.links[0].pieces[0].shape
    assert isinstance(thick, Box) and isinstance(fist, Sphere)
    assert parts == [0.5 * thick.size[2], fist.radius, PostureSettings().stand_off]
    assert height == pytest.approx(sum(parts), abs=1e-12)


def make_targets(text: str) -> set[str]:
    """Targets of make in the code of a page."""
    return set(re.findall(r"\bmake ([a-z]+)\b", " ".join(re.findall(r"```sh.*?```|`[^`]*`", text, re.DOTALL))))


def test_make_targets_exist_and_the_page_of_commands_has_all() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z]+):", makefile, re.MULTILINE))
    assert {"compare", "test"} <= make_targets(README) <= targets
    # `make` alone is the help
    assert make_targets(COMMANDS) == targets - {"help"}


def test_every_word_of_the_harness_is_on_the_page_of_commands() -> None:
    named = set(re.findall(r"python -m scenarios ([a-z]+)", COMMANDS)) | set(re.findall(r"`([a-z]+)`", COMMANDS))
    assert set(HARNESS) <= named


def test_the_page_of_commands_has_the_exit_codes_of_the_harness() -> None:
    [table] = re.findall(r"^## Exit codes\n.*?(^\|.*?)\n\n", COMMANDS, re.DOTALL | re.MULTILINE)
    assert {int(code) for code in re.findall(r"^\| (\d+) \|", table, re.MULTILINE)} == set(MEANINGS)
