"""BVH files that are damaged or made to harm end in a sentence that names file, line, value and what is valid."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from avatarsim.assets import caps
from avatarsim.assets.motions.bvh import read_bvh
from avatarsim.errors import InvalidFile
from tests.assets.motions.files import WALKER, bvh

GOOD = bvh(WALKER, np.linspace(0.0, 9.0, 90).reshape(3, 30))
DEEP = "".join(f"JOINT j{k}\n{{\nOFFSET 0 1 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n" for k in range(10_000))


def without(line: str) -> str:
    return GOOD.replace(line, "", 1)


CASES = {
    "nothing": (lambda: "", "end of bad.bvh is 'in the hierarchy'; valid: a line MOTION"),
    "another format": (lambda: "solid cube\n", "line 1 of bad.bvh is 'solid cube'; valid: HIERARCHY"),
    "cut off in the hierarchy": (lambda: GOOD[:200], "end of bad.bvh is 'in the hierarchy, with Head of line 10 open'"),
    "cut off before the frames": (lambda: GOOD[: GOOD.index("Frames")], "end of bad.bvh is 'after MOTION'; valid: Frames"),
    "cut off in the frames": (lambda: GOOD[: GOOD.rindex("\n", 0, -2)], "lines of frames in bad.bvh is 2; valid: 3, as line 64"),
    "cut off in a frame": (lambda: GOOD[:-40], "numbers in line 68 of bad.bvh is 2[0-9]; valid: 30"),
    "more frames than said": (lambda: GOOD.replace("Frames: 3", "Frames: 2"), "lines of frames in bad.bvh is 3; valid: 2"),
    "a thousand million frames": (
        lambda: GOOD.replace("Frames: 3", "Frames: 1000000000"), "number of frames in line 64 .* is '10",
    ),
    "no frame": (lambda: GOOD[: GOOD.index("Frames")] + "Frames: 0\nFrame Time: 1\n", "number of frames .* is '0'; valid: 1 to"),
    "frames that are no number": (lambda: GOOD.replace("Frames: 3", "Frames: three"), "is 'three'; valid: 1 to 1000000"),
    "no frame time": (lambda: without("Frame Time: 0.008333\n"), "line 65 of bad.bvh is '0.0 .*valid: Frame Time"),
    "a frame time of zero": (
        lambda: GOOD.replace("0.008333", "0"), r"frame time in line 65 of bad.bvh \[s\] is '0'; valid: above 0",
    ),
    "a negative frame time": (lambda: GOOD.replace("0.008333", "-1"), "frame time in line 65"),
    "not a number": (lambda: GOOD.replace("9.0\n", "nan\n"), "number in line 68 of bad.bvh is 'nan'; valid: a finite number"),
    "infinity": (lambda: GOOD.replace("9.0\n", "1e999\n"), "number in line 68 of bad.bvh is '1e999'"),
    "a word": (lambda: GOOD.replace("9.0\n", "nine\n"), "number in line 68 of bad.bvh is 'nine'"),
    "a number of Python's": (lambda: GOOD.replace("9.0\n", "9_0\n"), "number in line 68 of bad.bvh is '9_0'"),
    "an offset of two": (lambda: GOOD.replace("OFFSET 0 10 0", "OFFSET 0 10"), "numbers after OFFSET in line 8 of bad.bvh is 2"),
    "an offset too many": (lambda: GOOD.replace("OFFSET 0 10 0", "OFFSET 0 10 0\nOFFSET 1 1 1"), "valid: one OFFSET for Spine"),
    "an offset that is none": (lambda: GOOD.replace("OFFSET 0 10 0", "OFFSET 0 inf 0"), "number in line 8 of bad.bvh is 'inf'"),
    "no offset": (lambda: without("OFFSET 0 10 0"), "OFFSET of Spine, line 6 of bad.bvh is None"),
    "no channels": (lambda: without("CHANNELS 3 Zrotation Xrotation Yrotation"), "CHANNELS of Spine, line 6 of bad.bvh is None"),
    "channels without end": (
        lambda: GOOD.replace("CHANNELS 3 Z", "CHANNELS 1000000000 Z"), "number of channels in line 9 .*10000",
    ),
    "channels not listed": (
        lambda: GOOD.replace("CHANNELS 3 Z", "CHANNELS 4 Z"), "channels listed in line 9 of bad.bvh is 3; valid: 4",
    ),
    "a channel twice": (lambda: GOOD.replace("3 Zrotation X", "3 Xrotation X"), "channel in line 9 of bad.bvh is 'Xrotation'"),
    "an unknown channel": (lambda: GOOD.replace("3 Zrotation X", "3 Wrotation X"), "channel in line 9 of bad.bvh is 'Wrotation'"),
    "a name twice": (
        lambda: GOOD.replace("LeftForeArm", "LeftArm"), "name of a joint in line 23 .* is 'LeftArm'; valid: .* line 19",
    ),
    "a name that is a book": (lambda: GOOD.replace("Spine", "S" * 5000), "name of a joint in line 6 of bad.bvh is 'SSS"),
    "no name": (lambda: GOOD.replace("JOINT Spine", "JOINT"), "name of a joint in line 6 of bad.bvh is ''; valid: 1 to"),
    "two roots": (lambda: GOOD.replace("JOINT Spine", "ROOT Spine"), "line 6 of bad.bvh is 'ROOT Spine'; valid: one ROOT"),
    "no root": (lambda: "HIERARCHY\nMOTION\n", "joints of bad.bvh is 0; valid: a ROOT at least"),
    "a brace too many": (lambda: GOOD.replace("MOTION", "}\nMOTION"), "line 63 of bad.bvh is '}'; valid: a } for a {"),
    "no brace": (lambda: GOOD.replace("JOINT Spine\n\t{", "JOINT Spine\n"), "valid: { after the name of a joint"),
    "a joint in an end site": (lambda: GOOD.replace("OFFSET 0 25 0", "OFFSET 0 25 0\nJOINT x\n{\n}"), "valid: a JOINT within"),
    "a line of another kind": (lambda: GOOD.replace("OFFSET 0 10 0", "SCALE 3"), "line 8 of bad.bvh is 'SCALE 3'; valid: ROOT"),
    "ten thousand levels": (
        lambda: GOOD.replace("JOINT Spine", DEEP + "JOINT Spine"), f"joints of bad.bvh is 'more than {caps.LINKS}",
    ),
    "a line without end": (lambda: GOOD.replace("9.0\n", "9.0 " * caps.LINE), "length of line 68 of bad.bvh is 1049"),
    "a name without end": (lambda: GOOD.replace("Spine", "S" * 2 * caps.LINE), "length of line 6 of bad.bvh is 5242"),
    "bytes": (lambda: "\x00\x01\x02" * 100, "line 1 of bad.bvh is "),
}


@pytest.mark.parametrize("name", CASES)
def test_damaged_files_end_in_their_sentence(tmp_path: Path, name: str) -> None:
    text, sentence = CASES[name]
    assert isinstance(text, Callable)  # type: ignore[arg-type]
    path = tmp_path / "bad.bvh"
    path.write_text(text(), newline="")
    with pytest.raises(InvalidFile, match=sentence):
        read_bvh(path)


def test_the_file_without_damage_is_read(tmp_path: Path) -> None:
    path = tmp_path / "good.bvh"
    path.write_text(GOOD)
    assert len(read_bvh(path, scale=0.01).recording.values) == 3


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidFile, match=r"gone.bvh is 'No such file"):
        read_bvh(tmp_path / "gone.bvh")
    with pytest.raises(InvalidFile, match="a folder"):
        read_bvh(tmp_path)


def test_lines_are_counted_before_they_are_parted(tmp_path: Path) -> None:
    path = tmp_path / "bad.bvh"
    path.write_bytes(b"1\n" * (caps.LINES + 1))
    with pytest.raises(InvalidFile, match=f"lines of bad.bvh is {caps.LINES + 1}; valid: up to {caps.LINES}"):
        read_bvh(path)
