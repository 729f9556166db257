"""Figure 8: frame time of two arms pushed into a wall again and again: a spike per push, and nothing to do between them.

Time itself is measured in the benchmark; here the rounds of CCD that make it are counted, the same on every machine.
"""

import numpy as np

from tests.paper.scene_run import scene_run

FRAMES = 200


def iterations() -> np.ndarray:
    return np.array([record.counts["iterations"] for record in scene_run("two_arms", FRAMES, "paper")[1]])


def test_a_spike_for_every_push_and_silence_between() -> None:
    work = iterations()
    edges = np.diff((work > 0).astype(int))
    starts, ends = np.flatnonzero(edges == 1) + 1, np.flatnonzero(edges == -1) + 1
    assert len(starts) == 3 and len(ends) == 2
    for start, end in zip(starts, ends, strict=False):
        assert work[start:end].max() >= 8 and end - start > 30
    for end, start in zip(ends, starts[1:], strict=True):
        assert not work[end:start].any()


def test_work_falls_off_before_the_contact_ends() -> None:
    """The user lets go: ever fewer links are left to solve."""
    work = iterations()
    end = int(np.flatnonzero(np.diff((work > 0).astype(int)) == -1)[0]) + 1
    fall = work[end - 14 : end]
    assert (np.diff(fall) <= 0).all() and fall[0] >= 3 * fall[-1]
