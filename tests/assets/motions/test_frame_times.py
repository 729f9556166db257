"""Frame times: as stated by the file or by the user, and stated again for a motion at another rate."""

from typing import Any

import numpy as np
import pytest

from avatarsim.assets.motions.frame_times import restated, times_of
from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.scene.motion import Motion
from tests.assets.motions.test_archive import archive


def motion(times: list[float]) -> Motion:
    frames = len(times)
    return Motion(np.array(times), np.zeros((frames, 1, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (frames, 1, 1)), np.zeros((frames, 0)))


@pytest.mark.parametrize("stated", [
    {"fps": 50}, {"fps": [50]}, {"fps": 50.0}, {"mocap_framerate": 50}, {"mocap_frame_rate": np.array(50.0)}, {"frequency": 50.0},
    {"dt": 0.02}, {"times": [0.0, 0.02, 0.04]}, {"time": [5.0, 5.02, 5.04]}, {"times": [[0.0], [0.02], [0.04]]},
])
def test_every_way_to_state_a_rate(stated: dict[str, Any]) -> None:
    assert np.allclose(times_of(archive(**stated), 3, None), [0.0, 0.02, 0.04], atol=1e-12)


@pytest.mark.parametrize(("stated", "says"), [
    ({}, r"not stated.*rate=30"), ({"fps": [50, 60]}, "one number"), ({"fps": "50"}, "type of fps"),
    ({"fps": 0}, "frames a second"), ({"fps": -30.0}, "frames a second"), ({"fps": np.nan}, "finite"),
    ({"fps": 1e12}, "frames a second"), ({"dt": 0.0}, "dt of some.npz"),
    ({"times": [0.0, 0.1]}, "instants of times.*2.*3"), ({"times": [0.0, 0.2, 0.1]}, "step from frame 1 to the next"),
    ({"times": [0.0, 0.0, 0.1]}, "step from frame 0 to the next"), ({"times": [0.0, np.inf, 0.1]}, "finite"),
    ({"times": [0.0, 1.0, 1e9]}, "step from frame 1 to the next"),
])
def test_rates_that_no_recording_has_are_refused(stated: dict[str, Any], says: str) -> None:
    with pytest.raises(InvalidFile, match=says):
        times_of(archive(**stated), 3, None)


def test_another_rate_is_stated_in_the_files_own_way() -> None:
    faster = motion([0.0, 0.01, 0.02])
    found = restated(archive(fps=np.array([50]), dt=np.float32(0.02), times=np.array([5.0, 5.02]), more=3), faster)
    assert set(found) == {"fps", "dt", "times"}
    assert found["fps"].tolist() == [100] and found["fps"].dtype == np.int64
    assert found["dt"] == pytest.approx(0.01)
    assert np.allclose(found["times"], [5.0, 5.01, 5.02])


def test_uneven_steps_do_not_fit_into_a_rate() -> None:
    with pytest.raises(InvalidInput, match="equal steps"):
        restated(archive(fps=50), motion([0.0, 0.01, 0.03]))
    assert np.allclose(restated(archive(times=np.arange(4.0)), motion([0.0, 0.01, 0.03]))["times"], [0.0, 0.01, 0.03])
