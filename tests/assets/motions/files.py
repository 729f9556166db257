"""Small files of recorded skeletons, written out here."""

import numpy as np
from numpy.typing import ArrayLike

WALKER = """\
HIERARCHY
ROOT Hips
{
	OFFSET 0 0 0
	CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
	JOINT Spine
	{
		OFFSET 0 10 0
		CHANNELS 3 Zrotation Xrotation Yrotation
		JOINT Head
		{
			OFFSET 0 45 0
			CHANNELS 3 Yrotation Xrotation Zrotation
			End Site
			{
				OFFSET 0 25 0
			}
		}
		JOINT LeftArm
		{
			OFFSET 20 40 0
			CHANNELS 3 Xrotation Yrotation Zrotation
			JOINT LeftForeArm
			{
				OFFSET 28 0 0
				CHANNELS 3 Zrotation Yrotation Xrotation
				End Site
				{
					OFFSET 26 0 0
				}
			}
		}
	}
	JOINT LeftUpLeg
	{
		OFFSET 9 -5 0
		CHANNELS 3 Xrotation Zrotation Yrotation
		JOINT LeftLeg
		{
			OFFSET 0 -42 0
			CHANNELS 3 Yrotation Zrotation Xrotation
			JOINT LeftFoot
			{
				OFFSET 0 -40 0
				CHANNELS 3 Zrotation Yrotation Xrotation
				End Site
				{
					OFFSET 0 -5 16
				}
			}
		}
	}
	JOINT RightUpLeg
	{
		OFFSET -9 -5 0
		CHANNELS 3 Zrotation Yrotation Xrotation
		End Site
		{
			OFFSET 0 -80 0
		}
	}
}
"""
"""A human in centimetres with y up, every order of turns, 6 + 8 x 3 channels."""


def bvh(hierarchy: str, rows: ArrayLike, step: str = "0.008333") -> str:
    """A BVH file of a hierarchy and its rows (frames, channels)."""
    lines = [" ".join(map(repr, row)) for row in np.asarray(rows, dtype=np.float64).tolist()]
    return f"{hierarchy}MOTION\nFrames: {len(lines)}\nFrame Time: {step}\n" + "\n".join(lines) + "\n"

FOLDED = WALKER.replace("0 10 0", "10 0 0").replace("0 45 0", "45 0 0").replace("0 25 0", "25 0 0").replace("20 40 0", "40 5 0")
"""The same with trunk and legs along x at rest, as some tools write skeletons."""

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
  begin
     id 1
     name lhipjoint
     direction 0.655637 -0.713449 0.247245
     length 2.5
     axis 0 0 0  XYZ
  end
  begin
     id 2
     name lfemur
     direction 0.34202 -0.939693 0
     length 7.6
     axis 0 0 20  XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
     id 3
     name ltibia
     direction 0.34202 -0.939693 0
     length 7.3
     axis 0 0 20  XYZ
    dof rx
    limits (-10.0 170.0)
  end
  begin
     id 4
     name lfoot
     direction 0.0886837 -0.243657 0.965798
     length 2.2
     axis -90 10 20  XYZ
    dof rx rz
    limits (-45.0 90.0)
           (-70.0 20.0)
  end
  begin
     id 5
     name rhipjoint
     direction -0.655637 -0.713449 0.247245
     length 2.5
     axis 0 0 0  XYZ
  end
  begin
     id 6
     name rfemur
     direction -0.34202 -0.939693 0
     length 7.6
     axis 0 0 -20  ZYX
    dof rz ry rx
  end
  begin
     id 7
     name rfoot
     direction -0.4 -0.8 0.3
     length 7.5
     axis 5 15 -20  XYZ
    dof rx
  end
  begin
     id 8
     name lowerback
     direction 0.01 0.99 -0.1
     length 4.0
     axis 0 30 0  XYZ
    dof rx ry rz
  end
  begin
     id 9
     name head
     direction 0 1 0.1
     length 7.0
     axis 0 0 0  XYZ
    dof rx ry rz
  end
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
"""Bones of a frame and how many numbers each has: not in the skeleton's order."""


def amc(rows: ArrayLike, first: int = 1, head: str = "#!OML:ASF\n:FULLY-SPECIFIED\n:DEGREES\n") -> str:
    """An AMC file of rows (frames, 22)."""
    lines = []
    for frame, row in enumerate(np.asarray(rows, dtype=np.float64).tolist(), first):
        lines.append(str(frame))
        at = 0
        for bone, count in AMC_ORDER:
            lines.append(" ".join([bone, *map(repr, row[at : at + count])]))
            at += count
    return head + "\n".join(lines) + "\n"
