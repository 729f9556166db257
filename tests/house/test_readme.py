"""The README's examples run and print the values in their comments; the page of commands lists all commands."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import avatarsim as av
from avatarsim.scene.scene import Scene
from avatarsim.settings import CouplingSettings
from scenarios.__main__ import COMMANDS as HARNESS
from scenarios.run.gate import MEANINGS

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
ARM = """<robot name="arm"><link name="base"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="tool"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0.3 0 0"/><geometry><sphere radius="0.05"/></geometry></collision></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="tool"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
COMMANDS = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")


MUG, SHIELD = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def test_a_mug_is_lifted_by_as_much_as_the_comment_says(capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, object] = {}
    exec(MUG, names)
    height = float(capsys.readouterr().out)
    [said] = re.findall(r"^print\(.*\)  # ([\d.]+)", MUG, re.MULTILINE)
    scene = names["scene"]
    assert isinstance(scene, Scene) and height == float(said)
    mass = scene.bodies[1].mass
    assert mass is not None
    # two springs share the mug's weight
    sag = mass.mass * 9.81 / (2.0 * CouplingSettings().spring)
    assert height == pytest.approx(0.2 - sag, abs=1e-4)


def test_the_shield_follows_an_operator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.urdf").write_text(ARM, encoding="utf-8")
    sent: list[np.ndarray] = []
    robot = SimpleNamespace(is_on=lambda: len(sent) < 5, move=sent.append)
    operator = SimpleNamespace(coordinates=lambda: np.full(1, 0.001 * len(sent)))
    exec(SHIELD, {"av": av, "robot": robot, "operator": operator})
    assert len(sent) == 5 and 0.0 < sent[-1][0] <= 0.004


def make_targets(text: str) -> set[str]:
    """Return the make targets in the code of a page."""
    return set(re.findall(r"\bmake ([a-z]+)\b", " ".join(re.findall(r"```sh.*?```|`[^`]*`", text, re.DOTALL))))


def test_make_targets_exist_and_the_page_of_commands_has_all() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z]+):", makefile, re.MULTILINE))
    assert {"compare", "test"} <= make_targets(README) <= targets
    # `make` without a target prints the help
    assert make_targets(COMMANDS) == targets - {"help"}


def test_every_word_of_the_harness_is_on_the_page_of_commands() -> None:
    named = set(re.findall(r"python -m scenarios ([a-z]+)", COMMANDS)) | set(re.findall(r"`([a-z]+)`", COMMANDS))
    assert set(HARNESS) <= named


def test_the_page_of_commands_has_the_exit_codes_of_the_harness() -> None:
    [table] = re.findall(r"^## Exit codes\n.*?(^\|.*?)\n\n", COMMANDS, re.DOTALL | re.MULTILINE)
    assert {int(code) for code in re.findall(r"^\| (\d+) \|", table, re.MULTILINE)} == set(MEANINGS)
