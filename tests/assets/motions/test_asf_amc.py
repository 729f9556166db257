"""AMC files on their ASF skeletons: places of bones, notes, the same file again, and damaged ones."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from avatarsim.assets.motions.asf_amc import AmcFile, read_amc
from avatarsim.errors import InvalidFile
from avatarsim.scene.joint import Hinges, Rigid
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation
from tests.assets.motions.files import ASF, amc
from tests.assets.motions.robots import driven, places
from tests.assets.motions.twins import asf_places

Array = NDArray[np.float64]
UNIT = 0.0254 / 0.45


def rows(frames: int = 5, spread: float = 20.0) -> Array:
    found = np.random.default_rng(2).normal(0.0, spread, (frames, 22))
    found[:, :3] = np.linspace((0.0, 17.0, 0.0), (8.0, 18.0, 3.0), frames)
    return found


def made(folder: Path, text: str, asf: str = ASF, **options: object) -> AmcFile:
    """Return the file of a text, as 07_01.amc next to 07.asf."""
    (folder / "07.asf").write_bytes(asf.encode())
    (folder / "07_01.amc").write_bytes(text.encode())
    return read_amc(folder / "07_01.amc", **options)  # type: ignore[arg-type]


def test_bones_are_where_matrices_put_them(tmp_path: Path) -> None:
    values = rows(spread=60.0)
    file = made(tmp_path, amc(values), up="y", scale=UNIT)
    model = driven(file.model())
    for row, frame in zip(values, places(model, file.motion(model)), strict=True):
        expected = asf_places(ASF, row)
        for link, place in zip(model.avatar.links, frame, strict=True):
            x, y, z = UNIT * expected[link.name]
            assert np.abs(place - [x, -z, y]).max() < 1e-12


def test_radians_and_limits_are_read(tmp_path: Path) -> None:
    values = rows()
    degrees = made(tmp_path, amc(values), up="y")
    turned = np.concatenate([values[:, :3], np.radians(values[:, 3:])], axis=1)
    radians = made(tmp_path, amc(turned, head=":FULLY-SPECIFIED\n:RADIANS\n"), up="y")
    assert np.abs(degrees.recording.motion.rotations - radians.recording.motion.rotations).max() < 1e-12
    avatar = driven(degrees.model()).avatar
    knee = next(link.joint for link in avatar.links if link.name == "ltibia")
    foot = next(link.joint for link in avatar.links if link.name == "lfoot")
    assert isinstance(knee, Hinges) and isinstance(foot, Hinges) and isinstance(avatar.links[1].joint, Rigid)
    assert np.degrees([knee.hinges[0].lower, knee.hinges[0].upper]) == pytest.approx([-10.0, 170.0])
    # z is applied last, so its hinge is nearest the parent
    assert np.degrees([foot.hinges[0].lower, foot.hinges[1].lower]) == pytest.approx([-70.0, -45.0])


def test_numbers_come_back_and_others_are_nearest(tmp_path: Path) -> None:
    values = rows(spread=100.0)
    text = amc(values, first=7)
    file = made(tmp_path, text, up="y", limits=False)
    model = file.model()
    motion = file.motion(model)
    assert file.written(motion, model).decode() == text
    turned = rotation.multiply(motion.rotations, rotation.from_rotation_vector(np.full((5, 10, 3), 1e-3)))
    moved = Motion(motion.times, motion.positions + 0.01, turned, motion.angles + 0.01)
    back = made(tmp_path, file.written(moved, model).decode(), up="y", limits=False).recording
    balls = [k for k, bone in enumerate(back.skeleton.bones) if len(bone.axes) == 3]
    off = rotation.multiply(rotation.conjugate(turned), back.motion.rotations)[:, balls]
    assert np.linalg.norm(off[..., 1:], axis=-1).max() < 5e-10
    assert np.abs(back.motion.angles - moved.angles).max() < 1e-9
    assert np.abs(back.motion.positions[:, 0] - moved.positions[:, 0]).max() < 1e-9


def test_joints_beyond_limits_are_counted_and_left(tmp_path: Path) -> None:
    values = rows(spread=1.0)
    values[1:3, 15] = [-35.0, -12.0]
    file = made(tmp_path, amc(values), up="y")
    model = file.model()
    (beyond,) = [one for one in file.beyond_limits(model) if one.joint == "ltibia"]
    assert beyond.frames == 2 and np.degrees(beyond.most) == pytest.approx(25.0)
    hinges = [bone.name for bone in file.recording.skeleton.bones if len(bone.axes) in (1, 2) for _ in bone.axes]
    assert np.degrees(file.motion(model).angles[1, hinges.index("ltibia")]) == pytest.approx(-35.0)


def test_units_are_as_stated_or_guessed(tmp_path: Path) -> None:
    for asf in (ASF, ASF.replace("  length 0.45\n", ""), ASF.replace("length 0.45", "length 45")):
        assert made(tmp_path, amc(rows(spread=1.0)), asf).recording.axes.scale == pytest.approx(UNIT)
    assert made(tmp_path, amc(rows()), rate=60.0).recording.step == 1.0 / 60.0


def test_the_skeleton_is_found_or_asked_for(tmp_path: Path) -> None:
    made(tmp_path, amc(rows()))
    (tmp_path / "07.asf").rename(tmp_path / "body.asf")
    assert read_amc(tmp_path / "07_01.amc", skeleton=tmp_path / "body.asf").recording.skeleton.name == "body"
    with pytest.raises(InvalidFile, match="skeleton of 07_01.amc is None; valid: 07_01.asf or 07.asf beside it"):
        read_amc(tmp_path / "07_01.amc")


GOOD = amc(rows(3))
MOTIONS = (
    (GOOD, "", "end of 07_01.amc is 'before the first frame'"),
    (GOOD[GOOD.rindex("ltibia") :], "",
     r"bones that frame 3 of 07_01.amc lacks, at line 27 is \['ltibia', 'lfoot', 'rfemur', 'rfoot'\]"),
    (GOOD[GOOD.rindex(" ") :], "", "numbers of rfoot in line 30 of 07_01.amc is 0; valid: 1: rx"),
    *(("\n2\n", f"\n{number}\n", "of line 13|in line 13 of 07_01.amc") for number in ("5", "-3", "3.5")),
    *(("ltibia ", f"ltibia {value}\nx ", f"number in line 9 of 07_01.amc is '{value}'") for value in ("nan", "x")),
    ("ltibia ", "ltibia 1 2 ", "numbers of ltibia in line 9 of 07_01.amc is 3; valid: 1"),
    ("lfoot ", "ltibia ", "first word of line 10 of 07_01.amc is 'ltibia'; valid: the number"),
    ("ltibia ", "tail ", "first word of line 9 of 07_01.amc is 'tail'"),
    ("\n1\n", "\n" + "1" * 400 + "\n", "number of a frame in line 4"),
    ("ltibia ", "ltibia " + "1 " * 200_000, "length of line 9 of 07_01.amc is 400"),
)
"""Text in the valid motion, its replacement, and a part of the error."""


@pytest.mark.parametrize("case", range(len(MOTIONS)))
def test_damaged_motions_are_refused(tmp_path: Path, case: int) -> None:
    old, new, said = MOTIONS[case]
    with pytest.raises(InvalidFile, match=said):
        made(tmp_path, GOOD.replace(old, new, 1))


CHAIN = "".join(f"    b{k} b{k + 1}\n" for k in range(10_000))
SKELETONS = (
    (ASF, "", r"sections of 07.asf is \[\]; valid: :root among"),
    ("# made by hand", "x", "line 1 of 07.asf is 'x'; valid: a section"),
    (":bonedata", ":root\n:bonedata", "section of line .* is 'root'; valid: each section once"),
    (ASF[ASF.index(":hier") :], "", "valid: :hierarchy among them"),
    (ASF[ASF.index("id 5") :], "\n:hierarchy\n", "end of 07.asf is 'in the bone of line 53'; valid: end after each begin"),
    ("    root lhipjoint rhipjoint lowerback\n    lhipjoint lfemur\n    lfemur ltibia\n    ltibia lfoot",
     "    root rhipjoint lowerback\n    lhipjoint lfemur\n    lfemur ltibia\n    ltibia lhipjoint", "do not hang on the root"),
    ("lowerback head\n", "lowerback head ltibia\n", "bone in line .* is 'ltibia'; valid: bones that hang on one"),
    ("lowerback head\n", "lowerback root\n", "bone in line .* is 'root'; valid: bones that hang on one"),
    ("lowerback head\n", "lowerback tail\n", "bone in line .* is 'tail'; valid: root or a name"),
    ("name ltibia", "name lfemur", "name of the bone of line 34 of 07.asf is 'lfemur'; valid: another"),
    ("     name ltibia\n", "", "name of the bone of line 34 of 07.asf is None"),
    ("  end\n", "", "line 22 of 07.asf is 'begin'; valid: an end of the bone before"),
    ("           (-70.0 20.0)\n", "", "limits of lfoot, .* is 1; valid: 2, one for each"),
    *(("(-160.0 20.0)", limits, "07.asf") for limits in ("(20 -160)", "(nan 20)", "(inf -inf)", "(a b)", "(1e300 2e300)")),
    ("0.34202 -0.939693 0", "0.3 0.4", "numbers in line 26 of 07.asf is 2; valid: 3"),
    *(("direction 0.34202 -0.939693 0", f"direction {value}", "07.asf") for value in ("0 0 0", "nan 0 0", "x 0 0")),
    *(("length 7.3", f"length {value}", f"number in line 38 of 07.asf is '{value}'") for value in ("nan", "inf", "x")),
    ("length 7.3", "length -7.3", "length of ltibia, .* is -7.3; valid: 0 or more"),
    *(("length 0.45", f"length {value}", "in line 6 of 07.asf") for value in ("-0.45", "0", "nan", "x")),
    *(("mass 1.0", f"mass {value}", "in line 5 of 07.asf") for value in ("-1", "0", "nan", "x")),
    ("dof rx rz", "dof rx rw", "degree of freedom in line 49 of 07.asf is 'rw'"),
    ("-20  ZYX", "-20  ZZX", "order of axes in line 65 of 07.asf is 'ZZX'; valid: x, y and z"),
    *(("axis XYZ", f"axis {axis}", "line 12 of 07.asf") for axis in ("XYW", "XX", "")),
    ("axis 0 0 20  XYZ", "axis 0 0 nan  XYZ", "number in line .* is 'nan'"),
    ("angle deg", "angle gon", "unit of angle in line 7 of 07.asf is 'gon'; valid: deg or rad"),
    *(("position 0 0 0", f"position {value}", "line 13 of 07.asf") for value in ("0 nan 0", "0 0", "a b c")),
    ("orientation 0 0 0", "orientation 0 90 0", "orientation of root in line 14 of 07.asf"),
    ("     id 3\n", "     colour red\n", "line 35 of 07.asf is 'colour red'; valid: id, name"),
    ("lowerback head\n  end\n", "lowerback head\n  end\n" + CHAIN, "bone in line .* is 'b0'; valid: root or a name of :bone"),
    (":hierarchy", "".join(f"begin\nname b{k}\nend\n" for k in range(10_000)) + ":hierarchy", "bones of 07.asf is 'more than"),
)


@pytest.mark.parametrize("case", range(len(SKELETONS)))
def test_damaged_skeletons_are_refused(tmp_path: Path, case: int) -> None:
    old, new, said = SKELETONS[case]
    with pytest.raises(InvalidFile, match=said):
        made(tmp_path, GOOD, ASF.replace(old, new, 1))


def test_bones_that_slide_are_refused(tmp_path: Path) -> None:
    asf = ASF.replace("    dof rx\n    limits (-10.0 170.0)", "    dof tx\n    limits (-10.0 170.0)")
    with pytest.raises(InvalidFile, match=r"way tx of ltibia on its parent in 07_01.amc \[m\]"):
        made(tmp_path, GOOD, asf)


def test_whole_turns_stay_in_the_file_and_not_in_the_motion(tmp_path: Path) -> None:
    """A knee at 380 degrees is one at 20: within its limits as it is shown, and 380 where it is written."""
    values = rows(spread=1.0)
    values[:, 15] = 380.0
    file = made(tmp_path, amc(values), up="y")
    model = file.model()
    hinges = [bone.name for bone in file.recording.skeleton.bones[1:] if len(bone.axes) < 3 for _ in bone.axes]
    assert np.degrees(file.motion(model).angles[:, hinges.index("ltibia")]) == pytest.approx(20.0)
    assert file.written(file.motion(model), model).decode() == amc(values)
