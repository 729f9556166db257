"""Tables of text: the LAFAN1 convention without names, columns by name, and rows that keep their text if nothing moved."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import avatarsim as av
from avatarsim.assets import caps
from avatarsim.assets.motions.load import load_motion
from avatarsim.errors import InvalidFile, InvalidInput, UnknownName
from avatarsim.scene.motion import Motion
from tests.assets.motions.robots import JOINTS, robot, walk

FRAMES = 20
LAFAN = walk(FRAMES)[:, [0, 1, 2, 4, 5, 6, 3, 7, 8, 9, 10]]
ROOT = ("root_x", "root_y", "root_z", "root_qx", "root_qy", "root_qz", "root_qw")


def text(rows: np.ndarray, names: tuple[str, ...] = (), delimiter: str = ",", end: str = "\n", digits: str = ".6f") -> str:
    lines = [delimiter.join(names)] if names else []
    return end.join([*lines, *(delimiter.join(format(value, digits) for value in row) for row in rows)]) + end


def written(folder: Path, content: str | bytes, name: str = "some.csv") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def expected(rate: float = 30.0) -> Motion:
    coordinates = robot().coordinates
    return coordinates.motion(walk(FRAMES), np.arange(FRAMES) / rate)


def differs(a: Motion, b: Motion) -> float:
    return max(float(np.abs(getattr(a, name) - getattr(b, name)).max()) for name in ("times", "positions", "rotations", "angles"))


COUNTED = np.c_[np.arange(FRAMES), LAFAN]
TIMED = np.c_[LAFAN[:, 3:], np.arange(FRAMES) / 50.0, LAFAN[:, :3]]
BACKWARDS = np.c_[LAFAN[:, :7], LAFAN[:, :6:-1]]

FORMS: dict[str, tuple[str, dict[str, Any], float]] = {
    "LAFAN1": (text(LAFAN), {}, 30.0),
    "other rate": (text(LAFAN), {"rate": 50.0}, 50.0),
    "scalar first": (text(walk(FRAMES)), {"quaternion": "wxyz"}, 30.0),
    "rows counted": (text(COUNTED), {}, 30.0),
    "names": (text(BACKWARDS, (*ROOT, *(f"{joint}_dof" for joint in JOINTS[::-1]))), {}, 30.0),
    "names and times": (text(TIMED, (*ROOT[3:], *JOINTS, "time", *ROOT[:3]), digits=".9f"), {}, 50.0),
    "names and a count": (text(np.c_[COUNTED, COUNTED[:, 0]], ("Frame", *ROOT, *JOINTS, "tail")), {}, 30.0),
    "names by the user": (text(BACKWARDS), {"joints": ",".join(JOINTS[::-1])}, 30.0),
    "other names of a root": (
        text(LAFAN, (*(f"base_pos_{axis}" for axis in "xyz"), *(f"base_quat_{axis}" for axis in "xyzw"), *JOINTS)), {}, 30.0),
    "semicolons": (text(LAFAN, delimiter=";"), {}, 30.0),
    "tabs": (text(LAFAN, ROOT + JOINTS, delimiter="\t"), {}, 30.0),
    "spaces": (text(LAFAN, delimiter="  "), {}, 30.0),
    "lines of Windows": (text(LAFAN, end="\r\n"), {}, 30.0),
    "shortest digits": (text(LAFAN, digits=""), {}, 30.0),
}


@pytest.mark.parametrize("form", FORMS)
def test_tables_of_every_kind_are_one_motion_and_keep_their_text(tmp_path: Path, form: str) -> None:
    content, options, rate = FORMS[form]
    found = load_motion(written(tmp_path, content), **options)
    motion = found.motion(robot())
    assert found.format == "csv" and found.model() is None and differs(motion, expected(rate)) < 2e-6
    assert found.written(motion, robot()) == content.encode()
    angles = motion.angles.copy()
    angles[5:9, 2] += 1.0 / 3.0
    changed = replace(motion, angles=angles)
    other = found.written(changed, robot())
    assert differs(load_motion(written(tmp_path, other, "other.csv"), **options).motion(robot()), changed) < 1e-12
    lines, were = other.decode().splitlines(), content.splitlines()
    moved = [k for k, (now, was) in enumerate(zip(lines, were, strict=True)) if now != was]
    assert moved == [len(lines) - FRAMES + k for k in (5, 6, 7, 8)]


@given(st.integers(0, 30), st.integers(2, 8))
def test_every_number_survives(tmp_path_factory: pytest.TempPathFactory, seed: int, frames: int) -> None:
    folder = tmp_path_factory.mktemp("table")
    found = load_motion(written(folder, text(LAFAN[:frames])))
    motion = found.motion(robot())
    angles = np.random.default_rng(seed).uniform(-3.0, 3.0, motion.angles.shape)
    again = load_motion(written(folder, found.written(replace(motion, angles=angles), robot()), "other.csv")).motion(robot())
    # one hinge has a reference angle, which is subtracted and added again
    assert np.abs(again.angles - angles).max() < 1e-15


@pytest.mark.parametrize("form", ["LAFAN1", "names and times", "names and a count", "rows counted"])
def test_another_rate_has_other_rows(tmp_path: Path, form: str) -> None:
    content, options, rate = FORMS[form]
    found = load_motion(written(tmp_path, content), **options)
    motion = found.motion(robot()).resampled(2.0 * rate)
    again = load_motion(written(tmp_path, found.written(motion, robot()), "other.csv"), **options | {"rate": 2.0 * rate})
    assert len(again.motion(robot())) == 2 * FRAMES - 1
    assert differs(again.motion(robot()), motion) < 1e-9
    if form == "names and a count":
        counts = [line.partition(",")[0] for line in (tmp_path / "other.csv").read_text().splitlines()]
        assert counts[1:4] == ["0", "1", "2"]
    if "times" in form:
        stated = load_motion(tmp_path / "other.csv").motion(robot())
        assert np.abs(stated.times - motion.times).max() < 1e-9


def test_uneven_steps_need_a_column_of_times(tmp_path: Path) -> None:
    found = load_motion(written(tmp_path, FORMS["LAFAN1"][0]))
    motion = found.motion(robot())
    uneven = replace(motion, times=motion.times**1.1)
    with pytest.raises(InvalidInput, match="equal steps"):
        found.written(uneven, robot())
    timed = load_motion(written(tmp_path, FORMS["names and times"][0]))
    again = load_motion(written(tmp_path, timed.written(uneven, robot()), "other.csv")).motion(robot())
    assert np.abs(again.times - uneven.times).max() < 1e-9


def cell(row: int, column: int, word: str) -> str:
    lines = [line.split(",") for line in text(LAFAN).splitlines()]
    lines[row][column] = word
    return "\n".join(",".join(line) for line in lines) + "\n"


def test_names_without_a_root_drive_an_avatar_that_stands_fixed(tmp_path: Path) -> None:
    arm = tmp_path / "arm.urdf"
    links = '<link name="base"/><link name="a"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>'
    joint = '<parent link="base"/><child link="a"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/>'
    arm.write_text(f'<robot name="r">{links}<joint name="j" type="revolute">{joint}</joint></robot>')
    path = written(tmp_path, "time,j\n0,0.1\n0.5,0.2\n")
    file = load_motion(path)
    with pytest.raises(InvalidFile, match='root="fixed"'):
        file.motion(av.load_avatar(arm))
    model = av.load_avatar(arm, root="fixed")
    motion = file.motion(model)
    assert motion.angles.tolist() == [[0.1], [0.2]] and motion.times.tolist() == [0.0, 0.5]
    moved = file.written(replace(motion, angles=motion.angles + 0.25), model)
    assert moved.decode() == "time,j\n0.0,0.35\n0.5,0.45\n"


HOSTILE: dict[str, tuple[Callable[[], str | bytes], str]] = {
    "empty": (lambda: "", "rows of table"),
    "white": (lambda: "\n \n\t\n", "rows of table"),
    "names alone": (lambda: ",".join(ROOT + JOINTS), "rows of numbers"),
    "prose": (lambda: "It walks.\nIt runs, and then it falls.\n", "numbers of table some.csv"),
    "prose of numbers": (lambda: "a,b\n" + "c,d\n" * 5, "root's columns|numbers of table"),
    "mixed columns": (lambda: text(LAFAN) + "1,2,3\n", f"columns of row {FRAMES + 1} of some.csv is 3; valid: 11"),
    "a word": (lambda: cell(3, 8, "x"), "numbers of table some.csv"),
    "no number": (lambda: cell(3, 8, ""), "numbers of table some.csv"),
    "nan": (lambda: cell(3, 8, "nan"), "column 8 of frame 3 of table some.csv"),
    "infinity": (lambda: cell(3, 8, "-inf"), "column 8 of frame 3"),
    "overflow": (lambda: cell(3, 8, "1e400"), "column 8 of frame 3"),
    "huge angle": (lambda: cell(3, 8, "1e300"), "angle of left_shoulder in frame 3"),
    "huge place": (lambda: cell(3, 0, "1e300"), "distance of floating_base"),
    "no rotation": (lambda: cell(3, 6, "100"), "length of the quaternion of floating_base in frame 3"),
    "too few joints": (lambda: text(LAFAN[:, :9]), "names no joints.*9.*11"),
    "a name twice": (lambda: text(LAFAN, (*ROOT, *JOINTS[:3], JOINTS[0])), "name of column 10"),
    "a name too many": (lambda: text(LAFAN, (*ROOT, *JOINTS, "tail")), "columns of some.csv is 11; valid: 12, as its first row"),
    "unknown joints": (lambda: text(LAFAN, (*ROOT, "a", "b", "c", "d")), "missing: waist.*not the avatar's: a, b, c, d"),
    "angles of a root": (
        lambda: text(LAFAN[:, :10], (*ROOT[:3], "root_rot_x", "root_rot_y", "root_rot_z", *JOINTS)), "root's columns"),
    "times that stand still": (lambda: text(np.c_[np.zeros(FRAMES), LAFAN], ("time", *ROOT, *JOINTS)), "instant of row 2"),
    "many columns": (lambda: ",".join(["1"] * (caps.COLUMNS + 1)) + "\n", f"columns of row 1 of some.csv is {caps.COLUMNS + 1}"),
    "long name": (lambda: text(LAFAN, (*ROOT, *JOINTS[:3], "x" * 300)), "name of column 10"),
    "many lines": (lambda: "1\n" * (caps.FRAMES + 2), "frames of some.csv"),
    "one endless line": (lambda: "a" * (caps.COLUMNS * caps.NAME + 1), "characters of the first line"),
    "no text": (lambda: bytes(range(256)) * 4, "not UTF-8"),
    "another encoding": (lambda: text(LAFAN).encode("utf-16"), "not UTF-8"),
    "noughts": (lambda: bytes(1000), "root's columns|numbers of table|name of column"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_tables_end_in_a_sentence(tmp_path: Path, name: str) -> None:
    make, says = HOSTILE[name]
    with pytest.raises(InvalidFile, match=says):
        load_motion(written(tmp_path, make())).motion(robot())


def test_options_that_are_none_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, FORMS["LAFAN1"][0])
    with pytest.raises(UnknownName, match="wxyz, xyzw"):
        load_motion(path, quaternion="x")
    with pytest.raises(InvalidInput, match="rate"):
        load_motion(path, rate=0.0)


def test_refuses_joints_that_the_first_row_contradicts(tmp_path: Path) -> None:
    path = written(tmp_path, text(LAFAN, (*ROOT, *JOINTS)))
    assert differs(load_motion(path, joints=",".join(JOINTS)).motion(robot()), expected()) < 1e-5
    with pytest.raises(InvalidFile) as refused:
        load_motion(path, joints=["left_elbow", *JOINTS[1:]])
    assert "left_elbow" in str(refused.value) and JOINTS[0] in refused.value.valid
