"""Figure 7: cost of the hand's run. Idle for half of it, two plateaus while it slides over the table, spikes at the ball.

Time itself is measured in the benchmark; here the work that makes it is counted, which is the same on every machine.
"""

import numpy as np

from tests.paper.scene_run import scene_run


def work(name: str) -> np.ndarray:
    return np.array([record.counts[name] for record in scene_run("hand_over_table")[1]])


def test_idle_the_hand_asks_for_no_contact() -> None:
    half = len(work("rows")) // 2
    assert not work("rows")[: half - 20].any() and not work("segments")[10 : half - 20].any()


def test_two_plateaus_with_a_break_between() -> None:
    touching = work("rows")[: int(0.9 * len(work("rows")))] > 0
    edges = np.flatnonzero(np.diff(touching.astype(int)))
    lengths = np.diff(edges)[::2]
    plateaus = lengths[lengths > 50]
    assert len(plateaus) == 2 and np.ptp(plateaus) < 0.2 * plateaus.max()


def test_spikes_towards_the_end_when_the_ball_is_hit() -> None:
    impacts = work("impacts")
    assert not impacts[5 : int(0.9 * len(impacts))].any() and impacts[int(0.9 * len(impacts)) :].sum() >= 2
