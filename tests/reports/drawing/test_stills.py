"""Stills show all engines at the instant in which another engine overlaps most."""

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from reports.drawing.stills import instant, sides, stills
from reports.reading.kept import Drawn, Shown, drawn, shown
from tests.reports.recorded import STATES, recording, scene
from tests.reports.small_runs import MUJOCO, OURS


@pytest.fixture
def found(tmp_path: Path) -> tuple[Drawn, list[Shown]]:
    scene(tmp_path, "falls")
    for run in (OURS, MUJOCO):
        recording(tmp_path, "falls", run, sinks=run == MUJOCO)
    made = drawn(tmp_path, "falls")
    assert made is not None
    return made, shown(tmp_path, "falls", [OURS, MUJOCO])


def test_the_instant_is_that_of_the_deepest_overlap_of_another_engine(found: tuple[Drawn, list[Shown]]) -> None:
    ours, other = found[1]
    assert instant([ours, other], OURS) == 10
    deeper = replace(ours, pairs=[(3, 2, 0, 9.0)])
    assert instant([deeper, other], OURS) == 10 and instant([deeper, other], MUJOCO) == 3


def test_without_overlap_it_is_the_middle_and_a_short_recording_is_not_left(found: tuple[Drawn, list[Shown]]) -> None:
    ours, other = found[1]
    assert instant([ours], OURS) == STATES // 2
    assert instant([replace(ours, times=ours.times[:4]), other], OURS) in range(4)


def test_sides_are_across_the_push_of_the_contact(found: tuple[Drawn, list[Shown]]) -> None:
    ours = found[1][0]
    links = ours.raw_positions.shape[1]
    for push in ((0.02, 0.0), (0.0, -0.02), (0.02, 0.02)):
        moved = ours.positions.copy()
        moved[:, -links:, :2] = ours.raw_positions[:, :, :2] + push
        one, other = sides(replace(ours, positions=moved))
        assert all(abs(np.cos(turn) * push[0] + np.sin(turn) * push[1]) < 1e-12 for turn in (one, other))
        assert np.cos(one - other) == pytest.approx(-1.0)
    at_goal = ours.positions.copy()
    at_goal[:, -links:] = ours.raw_positions
    assert sides(replace(ours, positions=at_goal)) == ()


def _roles(svg: str) -> set[str]:
    return {node.attrib["class"][0] for node in ElementTree.fromstring(svg)}


def test_each_engine_has_a_picture_and_what_overlaps_has_a_role_of_its_own(found: tuple[Drawn, list[Shown]]) -> None:
    still = stills(found[0], found[1], OURS, 0.4)
    made = still.pictures
    assert still.time == found[1][0].times[instant(found[1], OURS)]
    assert [label for label, *_ in made] == ["avatarsim", "MuJoCo tuned"]
    (_, ours, calm), (_, other, deep) = made
    assert _roles(other) - _roles(ours) == {"o"} and calm != deep and "20 mm" in deep
    frames = {ElementTree.fromstring(svg).attrib["viewBox"] for svg in (ours, other)}
    assert len(frames) == 1


def test_a_state_that_is_no_number_has_no_picture_but_a_caption(found: tuple[Drawn, list[Shown]]) -> None:
    ours, other = found[1]
    gone = replace(other, positions=np.full_like(other.positions, np.nan))
    made = stills(found[0], [ours, gone], OURS, 0.4).pictures
    assert made[0][1] and made[1][1] == "" and made[1][2]
