"""Two recordings made by hand: which frames count, and who is nearer."""

from dataclasses import replace

import numpy as np
import pytest

from reference.judge import Judge
from scenarios.beside.pair import compared
from scenarios.record import Recording
from tests.scenarios.examples import WALL_FACE, fist, fist_motion, fist_scene, recorded

SCENE = fist_scene()


def shown(stops: float) -> Recording:
    """The user's fist goes into the wall; the one shown stops with its centre at x = `stops` [m]."""
    motion = fist_motion(SCENE, 0)
    recording = recorded(SCENE, [SCENE.first_sample, *(motion(k) for k in range(30))])
    positions = recording.positions.copy()
    positions[:, 1, 0] = np.minimum(positions[:, 1, 0], stops)
    return replace(recording, positions=positions)


def test_all_frames_count_while_at_most_a_millimetre_is_left() -> None:
    found = compared(shown(0.4), shown(0.4009), fist(), SCENE, Judge(SCENE))
    assert (found.frames, found.counted, found.winner) == (30, 30, ("theirs", "same"))
    # the user is up to 0.2 m beyond 0.4
    beyond = np.maximum(0.02 * np.arange(1, 31) - 0.4, 0.0)
    assert found.offset == pytest.approx(np.sqrt(np.mean(beyond**2)), abs=1e-12)


def test_frames_with_more_overlap_do_not_count() -> None:
    found = compared(shown(0.4), shown(0.405), fist(), SCENE, Judge(SCENE))
    # 0.41 would be the 21st frame's; from there on 5 mm are left
    assert found.counted == 20 and found.winner == ("same", "same")


def test_frames_on_the_wrong_side_do_not_count() -> None:
    through = shown(0.4)
    positions = through.positions.copy()
    positions[25:, 1, 0] = WALL_FACE + 2.0
    found = compared(shown(0.39), replace(through, positions=positions), fist(), SCENE, Judge(SCENE))
    assert found.counted == 24 and found.winner == ("theirs", "same")


def test_no_numbers_do_not_count_and_nothing_is_nobodys() -> None:
    broken = shown(0.4)
    positions = np.full_like(broken.positions, np.nan)
    found = compared(shown(0.4), replace(broken, positions=positions), fist(), SCENE, Judge(SCENE))
    assert found.counted == 0 and found.winner == ("-", "-")


def test_ours_is_not_asked_which_frames_count() -> None:
    # ours deep in the wall wins nothing by leaving more overlap: the frames are theirs
    found = compared(shown(0.5), shown(0.4), fist(), SCENE, Judge(SCENE))
    assert found.counted == 30 and found.winner[0] == "ours"
