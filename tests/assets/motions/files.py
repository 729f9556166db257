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
