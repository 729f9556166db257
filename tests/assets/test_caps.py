"""Limits on untrusted files: values at a limit pass, values beyond are refused with the limit, before the file is read."""


import pytest

from avatarsim.assets import caps
from avatarsim.errors import InvalidFile


def test_a_motion_may_be_as_long_as_the_limits_say() -> None:
    caps.require_frames("some.npz", caps.FRAMES)
    caps.require_frames("some.npz", caps.LINK_FRAMES // 30, 30)
    with pytest.raises(InvalidFile, match=rf"frames of some\.npz.*{caps.FRAMES}"):
        caps.require_frames("some.npz", caps.FRAMES + 1)
    with pytest.raises(InvalidFile, match=rf"{caps.LINK_FRAMES // 30} for an avatar of 30 links"):
        caps.require_frames("some.npz", caps.LINK_FRAMES // 30 + 1, 30)


@pytest.mark.parametrize("name", ["", "x" * (caps.NAME + 1), "a\nb", "a\x00", "\u202eabc"])
def test_names_that_cannot_be_shown_are_refused(name: str) -> None:
    with pytest.raises(InvalidFile, match="printable"):
        caps.require_name("joint", name)
    assert caps.require_name("joint", "x" * caps.NAME) == "x" * caps.NAME
