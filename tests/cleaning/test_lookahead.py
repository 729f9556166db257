"""Fading of a smoothed displacement towards frames that kept the input, against the nearest such frame by search."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.cleaning.lookahead import faded


@given(is_input=st.lists(st.booleans(), min_size=1, max_size=60), half=st.integers(1, 12), seed=st.integers(0, 100))
def test_a_displacement_fades_with_the_distance_to_kept_frames(is_input: list[bool], half: int, seed: int) -> None:
    kept, random = np.array(is_input), np.random.default_rng(seed)
    first, smooth = random.normal(size=(2, len(kept), 3))
    first[kept] = 0.0
    found = faded(first, smooth, kept, half)
    for frame, one in enumerate(found):
        away = min((abs(frame - other) for other in np.flatnonzero(kept)), default=half + 1)
        share = 0.5 - 0.5 * np.cos(np.pi * min(1.0, away / (half + 1)))
        assert np.allclose(one, first[frame] + share * (smooth[frame] - first[frame]), rtol=0.0, atol=1e-12)
    assert not found[kept].any()
