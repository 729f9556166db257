"""Small files of recorded skeletons, written out here."""

import numpy as np
from numpy.typing import ArrayLike


def joint(name: str, offset: str, turns: str, *inside: str) -> str:
    """Return a joint of a BVH file with turns by their axes in order, and joints or an end inside."""
    channels = " ".join(f"{axis}rotation" for axis in turns)
    return _block(f"JOINT {name}", f"OFFSET {offset}", f"CHANNELS {len(turns)} {channels}", *inside)


def root(name: str, turns: str, *inside: str) -> str:
    """Return a hierarchy of BVH below a root that also moves."""
    channels = " ".join(["6 Xposition Yposition Zposition", *(f"{axis}rotation" for axis in turns)])
    return "HIERARCHY\n" + _block(f"ROOT {name}", "OFFSET 0 0 0", f"CHANNELS {channels}", *inside) + "\n"


def end(offset: str) -> str:
    """Return the end of a limb."""
    return _block("End Site", f"OFFSET {offset}")


def _block(head: str, *lines: str) -> str:
    inside = "\n".join("\t" + line for block in lines for line in block.split("\n"))
    return f"{head}\n{{\n{inside}\n}}"


WALKER = root(
    "Hips", "ZYX",
    joint(
        "Spine", "0 10 0", "ZXY", joint("Head", "0 45 0", "YXZ", end("0 25 0")),
        joint("LeftArm", "20 40 0", "XYZ", joint("LeftForeArm", "28 0 0", "ZYX", end("26 0 0"))),
    ),
    joint(
        "LeftUpLeg", "9 -5 0", "XZY",
        joint("LeftLeg", "0 -42 0", "YZX", joint("LeftFoot", "0 -40 0", "ZYX", end("0 -5 16"))),
    ),
    joint("RightUpLeg", "-9 -5 0", "ZYX", end("0 -80 0")),
)
"""A human in centimetres with y up, every order of turns, 6 + 8 x 3 channels."""


def bvh(hierarchy: str, rows: ArrayLike, step: str = "0.008333") -> str:
    """Return a BVH file of a hierarchy and its rows (frames, channels)."""
    lines = [" ".join(map(repr, row)) for row in np.asarray(rows, dtype=np.float64).tolist()]
    return f"{hierarchy}MOTION\nFrames: {len(lines)}\nFrame Time: {step}\n" + "\n".join(lines) + "\n"


BONES = (
    ("lhipjoint", "0.655637 -0.713449 0.247245", "2.5", "0 0 0  XYZ", "", ()),
    ("lfemur", "0.34202 -0.939693 0", "7.6", "0 0 20  XYZ", "rx ry rz", ("(-160.0 20.0)", "(-70.0 70.0)", "(-60.0 70.0)")),
    ("ltibia", "0.34202 -0.939693 0", "7.3", "0 0 20  XYZ", "rx", ("(-10.0 170.0)",)),
    ("lfoot", "0.0886837 -0.243657 0.965798", "2.2", "-90 10 20  XYZ", "rx rz", ("(-45.0 90.0)", "(-70.0 20.0)")),
    ("rhipjoint", "-0.655637 -0.713449 0.247245", "2.5", "0 0 0  XYZ", "", ()),
    ("rfemur", "-0.34202 -0.939693 0", "7.6", "0 0 -20  ZYX", "rz ry rx", ()),
    ("rfoot", "-0.4 -0.8 0.3", "7.5", "5 15 -20  XYZ", "rx", ()),
    ("lowerback", "0.01 0.99 -0.1", "4.0", "0 30 0  XYZ", "rx ry rz", ()),
    ("head", "0 1 0.1", "7.0", "0 0 0  XYZ", "rx ry rz", ()),
)
"""Name, direction, length, axis, degrees of freedom and limits of the bones of a skeleton."""


def _bone(number: int, name: str, direction: str, length: str, axis: str, dof: str, limits: tuple[str, ...]) -> str:
    text = f"  begin\n     id {number}\n     name {name}\n     direction {direction}\n     length {length}\n     axis {axis}\n"
    text += f"    dof {dof}\n" if dof else ""
    text += f"    limits {(chr(10) + ' ' * 11).join(limits)}\n" if limits else ""
    return text + "  end\n"


ASF = """\
# made by hand
:version 1.10
:name small
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
   any words: root begin (
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
""" + "".join(_bone(k, *bone) for k, bone in enumerate(BONES, 1)) + """\
:hierarchy
  begin
    root lhipjoint rhipjoint lowerback
    lhipjoint lfemur
    lfemur ltibia
    ltibia lfoot
    rhipjoint rfemur
    rfemur rfoot
    lowerback head
  end
"""
"""A skeleton with legs, a trunk and a head, in units of 1/0.45 inch and degrees, y up."""

AMC_ORDER = (("root", 6), ("head", 3), ("lowerback", 3), ("lfemur", 3), ("ltibia", 1), ("lfoot", 2), ("rfemur", 3), ("rfoot", 1))
"""Bones of a frame with their counts of numbers, in another order than the skeleton's."""


def amc(rows: ArrayLike, first: int = 1, head: str = "#!OML:ASF\n:FULLY-SPECIFIED\n:DEGREES\n") -> str:
    """Return an AMC file of rows (frames, 22)."""
    lines = []
    for frame, row in enumerate(np.asarray(rows, dtype=np.float64).tolist(), first):
        lines.append(str(frame))
        at = 0
        for bone, count in AMC_ORDER:
            lines.append(" ".join([bone, *map(repr, row[at : at + count])]))
            at += count
    return head + "\n".join(lines) + "\n"
