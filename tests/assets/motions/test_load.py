"""`load_motion`: which reader takes which file, and with which options."""

from pathlib import Path

import numpy as np
import pytest

import avatarsim as av
from avatarsim.errors import InvalidFile, InvalidInput
from tests.assets.motions.files import ASF, WALKER, amc, bvh


def test_files_are_known_by_the_end_of_their_names(tmp_path: Path) -> None:
    (tmp_path / "a.BVH").write_text(bvh(WALKER, np.zeros((2, 30))))
    (tmp_path / "b.asf").write_text(ASF)
    (tmp_path / "b.amc").write_text(amc(np.zeros((2, 22))))
    assert [av.load_motion(tmp_path / name).format for name in ("a.BVH", "b.amc")] == ["bvh", "amc"]
    assert av.load_motion(str(tmp_path / "a.BVH"), scale=0.02, up="z").said == ()


def test_other_files_and_options_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidFile, match="end of the name of clip.fbx is '.fbx'; valid: one of .amc, .bvh"):
        av.load_motion(tmp_path / "clip.fbx")
    with pytest.raises(InvalidInput, match="option for clip.bvh is 'size'; valid: one of limits, mass, offsets, scale, up"):
        av.load_motion(tmp_path / "clip.bvh", size=2)
