"""Damaged or malicious BVH files are refused by file, line, value and valid range."""

from pathlib import Path

import numpy as np
import pytest

from avatarsim.assets import caps
from avatarsim.assets.motions.bvh import read_bvh
from avatarsim.errors import InvalidFile
from tests.assets.motions.files import WALKER, bvh

GOOD = bvh(WALKER, np.linspace(0.0, 9.0, 90).reshape(3, 30))
DEEP = "".join(f"JOINT j{k}\n{{\nOFFSET 0 1 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n" for k in range(10_000))

WHOLE = {
    "": "end of bad.bvh is 'in the hierarchy'; valid: a line MOTION",
    "solid cube\n": "line 1 of bad.bvh is 'solid cube'; valid: HIERARCHY",
    GOOD[:200]: "end of bad.bvh is 'in the hierarchy, with Head of line 10 open'",
    GOOD[: GOOD.index("Frames")]: "end of bad.bvh is 'after MOTION'; valid: Frames",
    GOOD[: GOOD.rindex("\n", 0, -2)]: "lines of frames in bad.bvh is 2; valid: 3, as line 64",
    GOOD[:-40]: "numbers in line 68 of bad.bvh is 2[0-9]; valid: 30",
    GOOD[: GOOD.index("Frames")] + "Frames: 0\nFrame Time: 1\n": "number of frames .* is '0'; valid: 1 to",
    "HIERARCHY\nMOTION\n": "joints of bad.bvh is 0; valid: a ROOT at least", "\x00\x01\x02" * 100: "line 1 of bad.bvh is ",
}
CHANGED = (
    ("Frames: 3", "Frames: 2", "lines of frames in bad.bvh is 3; valid: 2"),
    ("Frames: 3", "Frames: 1000000000", "number of frames in line 64 .* is '10"),
    ("Frames: 3", "Frames: three", "is 'three'; valid: 1 to 1000000"),
    *(("Frames: 3", f"Frames: {count}", f"number of frames in line 64 .* is '{count}'") for count in ("-5", "nan", "1e3")),
    ("Frame Time: 0.008333\n", "", "line 65 of bad.bvh is '0.0 .*valid: Frame Time"),
    *(("0.008333", time, rf"frame time in line 65 of bad.bvh( \[s\])? is '{time}'") for time in ("0", "-1", "1e9")),
    *(("0.008333", time, f"in line 65 of bad.bvh.* is '{time}'") for time in ("nan", "inf", "x")),
    *(("9.0\n", f"{value}\n", f"number in line 68 of bad.bvh is '{value}'") for value in ("nan", "1e999", "nine", "9_0")),
    ("9.0\n", "1e30\n", "bad.bvh"),
    ("OFFSET 0 10 0", "OFFSET 0 10", "numbers after OFFSET in line 8 of bad.bvh is 2"),
    ("OFFSET 0 10 0", "OFFSET 0 10 0\nOFFSET 1 1 1", "valid: one OFFSET for Spine"),
    *(("OFFSET 0 10 0", f"OFFSET 0 {value} 0", f"number in line 8 of bad.bvh is '{value}'") for value in ("inf", "nan", "x")),
    ("OFFSET 0 10 0", "OFFSET 0 1e30 0", "bad.bvh"),
    ("OFFSET 0 10 0", "", "OFFSET of Spine, line 6 of bad.bvh is None"),
    ("CHANNELS 3 Zrotation Xrotation Yrotation", "", "CHANNELS of Spine, line 6 of bad.bvh is None"),
    ("CHANNELS 3 Z", "CHANNELS 1000000000 Z", "number of channels in line 9 .*10000"),
    ("CHANNELS 3 Z", "CHANNELS 4 Z", "channels listed in line 9 of bad.bvh is 3; valid: 4"),
    *(("3 Zrotation X", f"3 {axis}rotation X", f"channel in line 9 of bad.bvh is '{axis}rotation'") for axis in "XW"),
    ("LeftForeArm", "LeftArm", "name of a joint in line 23 .* is 'LeftArm'; valid: .* line 19"),
    ("Spine", "S" * 5000, "name of a joint in line 6 of bad.bvh is 'SSS"),
    ("JOINT Spine", "JOINT", "name of a joint in line 6 of bad.bvh is ''; valid: 1 to"),
    ("JOINT Spine", "ROOT Spine", "line 6 of bad.bvh is 'ROOT Spine'; valid: one ROOT"),
    ("MOTION", "}\nMOTION", "line 63 of bad.bvh is '}'; valid: a } for a {"),
    ("JOINT Spine\n\t{", "JOINT Spine\n", "valid: { after the name of a joint"),
    ("OFFSET 0 25 0", "OFFSET 0 25 0\nJOINT x\n{\n}", "valid: a JOINT within"),
    ("OFFSET 0 10 0", "SCALE 3", "line 8 of bad.bvh is 'SCALE 3'; valid: ROOT"),
    ("JOINT Spine", DEEP + "JOINT Spine", f"joints of bad.bvh is 'more than {caps.LINKS}"),
    ("9.0\n", "9.0 " * caps.LINE, "length of line 68 of bad.bvh is 1049"),
    ("Spine", "S" * 2 * caps.LINE, "length of line 6 of bad.bvh is 5242"),
)
"""Text in the valid file, its replacement, and a part of the error."""


@pytest.mark.parametrize("case", range(len(WHOLE) + len(CHANGED)))
def test_damaged_files_are_refused(tmp_path: Path, case: int) -> None:
    text, said = [*WHOLE.items(), *((GOOD.replace(old, new, 1), said) for old, new, said in CHANGED)][case]
    path = tmp_path / "bad.bvh"
    path.write_text(text, newline="")
    with pytest.raises(InvalidFile, match=said):
        read_bvh(path)


def test_lines_are_counted_before_they_are_parted(tmp_path: Path) -> None:
    path = tmp_path / "bad.bvh"
    path.write_bytes(b"1\n" * (caps.LINES + 1))
    with pytest.raises(InvalidFile, match=f"lines of bad.bvh is {caps.LINES + 1}; valid: up to {caps.LINES}"):
        read_bvh(path)
