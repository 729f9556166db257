"""The frames of Figure 7 are timed one by one, and contact is found where the raw hand is inside the table."""

import numpy as np

from scenarios.job import Job
from scenarios.table_2.figure_7 import SCENE, contact, traces


def test_every_frame_has_a_time() -> None:
    found = traces(frames=12, repeats=2)
    assert [trace.run for trace in found] == ["avatarsim/default", "avatarsim/paper"]
    for trace in found:
        assert trace.us.shape == trace.contact.shape == (12,)
        assert (trace.us > 0.0).all() and not trace.contact.any()
        assert "posture" in trace.shares and 99.0 < sum(trace.shares.values()) < 101.0


def test_the_hand_slides_twice_over_the_table() -> None:
    """At its short length the raw hand is inside the table in two stretches: there and back."""
    touches = contact(Job(SCENE, "avatarsim", "default"))
    begins = np.flatnonzero(touches[1:] & ~touches[:-1])
    assert len(touches) == 900 and len(begins) >= 2 and 0.2 < touches.mean() < 0.8
