"""Pictures of a recorded scene: the thumbnail of one state, and stills of all engines where another engine overlaps most."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from reports.drawing.stills import instant, sides, stills
from reports.drawing.thumbnail import HEIGHT, WIDTH, thumbnail
from reports.reading.kept import Drawn, Shown, read_scene, shown
from tests.reports.recorded import STATES, recording, scene
from tests.reports.small_runs import MUJOCO, OURS

Recorded = tuple[Drawn, Shown, Shown]


@pytest.fixture
def found(tmp_path: Path) -> Recorded:
    """Return the scene, our recording and another one, in which the hand sinks into the slab."""
    scene(tmp_path, "falls")
    for run in (OURS, MUJOCO):
        recording(tmp_path, "falls", run, sinks=run == MUJOCO)
    made = read_scene(tmp_path, "falls")
    assert made is not None
    ours, other = shown(tmp_path, "falls", [OURS, MUJOCO])
    return made, ours, other


def styles(svg: str) -> Counter[str]:
    """Return the number of parts of each style."""
    return Counter(node.attrib["class"] for node in ElementTree.fromstring(svg))


def paths(svg: str) -> str:
    return " ".join(re.findall(r' d="([^"]*)"', svg))


def test_every_body_is_drawn_in_its_role_inside_the_frame(found: Recorded) -> None:
    svg = thumbnail(*found[:2], 9, -1.0, 'A "scene" <of> three.')
    assert styles(svg)["s2"] == styles(svg)["d2"] == 1
    # three sides of the slab face a viewpoint above
    assert sum(number for style, number in styles(svg).items() if style[0] == "f") == 3
    assert len(svg) < 2000 and ElementTree.fromstring(svg).attrib["aria-label"] == 'A "scene" <of> three.'
    numbers = [float(text) for text in re.findall(r'(?<=[ML,"])-?\d+(?=[,LZ"])', paths(svg))]
    assert numbers and min(numbers) >= -9 and max(numbers) <= max(WIDTH, HEIGHT) + 9


def test_a_link_away_from_its_target_has_a_ghost(found: Recorded) -> None:
    made, main, _ = found
    assert "g" not in styles(thumbnail(made, main, 3, 0.0, "x"))
    moved = main.raw_positions.copy()
    moved[3] -= [0.0, 0.0, 0.2]
    assert styles(thumbnail(made, replace(main, raw_positions=moved), 3, 0.0, "x"))["g"] == 1


def test_states_that_are_no_numbers_are_left_out(found: Recorded) -> None:
    made, main, other = found
    gone = replace(other, positions=np.full_like(other.positions, np.nan))
    pictures = stills(made, [main, gone], OURS, 0.4).pictures
    assert pictures[0][1] and pictures[1][1] == "" and pictures[1][2]
    main.positions[3, 1] = np.nan
    assert "s2" not in styles(thumbnail(made, main, 3, 0.0, "x"))
    main.positions[3, 2] = np.inf
    assert thumbnail(made, main, 3, 0.0, "x") == ""


def test_stills_are_at_the_deepest_overlap_of_another_engine(found: Recorded) -> None:
    _, ours, other = found
    assert instant([ours, other], OURS) == 10
    deeper = replace(ours, pairs=[(3, 2, 0, 9.0)])
    assert instant([deeper, other], OURS) == 10 and instant([deeper, other], MUJOCO) == 3
    # without overlap it is the middle, within a short recording
    assert instant([ours], OURS) == STATES // 2
    assert instant([replace(ours, times=ours.times[:4]), other], OURS) in range(4)


def test_sides_are_across_the_push_of_the_contact(found: Recorded) -> None:
    ours = found[1]
    links = ours.raw_positions.shape[1]
    for push in ((0.02, 0.0), (0.0, -0.02), (0.02, 0.02)):
        moved = ours.positions.copy()
        moved[:, -links:, :2] = ours.raw_positions[:, :, :2] + push
        one, other = sides(replace(ours, positions=moved))
        assert all(abs(np.cos(turn) * push[0] + np.sin(turn) * push[1]) < 1e-12 for turn in (one, other))
        assert np.cos(one - other) == pytest.approx(-1.0)
    assert sides(ours) == ()


def test_each_engine_has_a_still_that_marks_overlap(found: Recorded) -> None:
    made, *recordings = found
    still = stills(made, recordings, OURS, 0.4)
    assert still.time == recordings[0].times[instant(recordings, OURS)] and len(still.pictures) == 2
    (_, ours, _), (_, other, deep) = still.pictures
    assert {style[0] for style in styles(other)} - {style[0] for style in styles(ours)} == {"o"} and "20 mm" in deep
    assert len({ElementTree.fromstring(svg).attrib["viewBox"] for svg in (ours, other)}) == 1
