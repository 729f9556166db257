"""What the README shows works, and prints what it says."""

import re
from pathlib import Path

import pytest

from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Sphere
from avatarsim.settings import PostureSettings

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


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


def test_every_make_target_it_names_exists() -> None:
    makefile = (Path(__file__).parents[2] / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z]+):", makefile, re.MULTILINE))
    assert set(re.findall(r"\bmake ([a-z]+)\b", " ".join(re.findall(r"`[^`]*`|```sh.*?```", README, re.DOTALL)))) <= targets
