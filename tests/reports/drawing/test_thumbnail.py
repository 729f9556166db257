"""The picture of a scene is small, described and inside its frame."""

import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from reports.drawing.thumbnail import HEIGHT, WIDTH, thumbnail
from reports.reading.kept import Drawn, Shown, drawn, shown
from tests.reports.recorded import recording, scene


@pytest.fixture
def found(tmp_path: Path) -> tuple[Drawn, Shown]:
    scene(tmp_path, "falls")
    recording(tmp_path, "falls", "mine/default")
    made = drawn(tmp_path, "falls")
    assert made is not None
    return made, shown(tmp_path, "falls", ["mine/default"])[0]


def parts(svg: str) -> dict[str, int]:
    tally: dict[str, int] = {}
    for node in ElementTree.fromstring(svg):
        tally[node.attrib["class"]] = tally.get(node.attrib["class"], 0) + 1
    return tally


def test_every_body_is_drawn_in_its_role(found: tuple[Drawn, Shown]) -> None:
    svg = thumbnail(*found, 9, -1.0, 'A "scene" <of> three.')
    assert parts(svg)["s2"] == parts(svg)["d2"] == 1
    # three sides of the slab look towards an eye above
    assert sum(number for style, number in parts(svg).items() if style[0] in "fv") == 3
    assert len(svg) < 2000 and 'aria-label="A &quot;scene&quot; &lt;of&gt; three."' in svg
    numbers = [float(text) for text in re.findall(r'(?<=[ML,"])-?\d+(?=[,LZ"])', " ".join(re.findall(r' d="([^"]*)"', svg)))]
    assert numbers and min(numbers) >= -9 and max(numbers) <= max(WIDTH, HEIGHT) + 9


def test_a_link_that_is_held_off_has_a_ghost(found: tuple[Drawn, Shown]) -> None:
    made, main = found
    assert "g" not in parts(thumbnail(made, main, 3, 0.0, "x"))
    moved = main.raw_positions.copy()
    moved[3] -= [0.0, 0.0, 0.2]
    assert parts(thumbnail(made, replace(main, raw_positions=moved), 3, 0.0, "x"))["g"] == 1


def test_what_is_no_number_is_left_out(found: tuple[Drawn, Shown]) -> None:
    made, main = found
    main.positions[3, 1] = np.nan
    assert "s2" not in parts(thumbnail(made, main, 3, 0.0, "x"))
    main.positions[3, 2] = np.inf
    assert thumbnail(made, main, 3, 0.0, "x") == ""


def test_a_floor_of_a_kilometre_stays_in_the_frame(found: tuple[Drawn, Shown], tmp_path: Path) -> None:
    made, main = found
    wide = [dict(body) for body in made.bodies]
    wide[0]["pieces"] = [wide[0]["pieces"][0] | {"size": [1000.0, 1000.0, 0.1]}]
    svg = thumbnail(Drawn(wide, made.gravity), main, 3, 0.4, "x")
    assert len(svg) < 2000 and not re.search(r"\d{4}", " ".join(re.findall(r' d="([^"]*)"', svg)))
