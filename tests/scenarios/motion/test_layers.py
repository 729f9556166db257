"""The legs of one clip under the upper body of another."""

import numpy as np
import pytest

from avatarsim.errors import InvalidInput
from scenarios.motion.layers import UPPER, upper_body_of
from scenarios.motion.mocap import load_clip, retimed


def test_each_link_moves_as_in_its_own_clip() -> None:
    walk, spin = retimed(load_clip("walk")), retimed(load_clip("spin"))
    both = upper_body_of(spin, 10.0 / 60.0, walk)
    frames = len(walk.times)
    np.testing.assert_array_equal(both.times, walk.times)
    np.testing.assert_array_equal(both.root_positions, walk.root_positions)
    for kind in ("rotations", "angles"):
        for link, values in getattr(both, kind).items():
            expected = getattr(spin, kind)[link][10 : 10 + frames] if link in UPPER else getattr(walk, kind)[link]
            np.testing.assert_array_equal(values, expected)


def test_an_upper_layer_that_ends_too_early_is_refused() -> None:
    walk, spin = retimed(load_clip("walk")), retimed(load_clip("spin"))
    with pytest.raises(InvalidInput, match=r"start of clip spin.*at most 3\.1"):
        upper_body_of(spin, 4.0, walk)
