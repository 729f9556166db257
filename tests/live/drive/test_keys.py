"""Speeds that presses of keys ask for."""

from avatarsim.live.drive.keys import DECAY, Speeds
from tests.live.drive.stages_driven import DT


def ticks(speeds: Speeds, seconds: float) -> None:
    """Let time pass frame by frame."""
    for _ in range(round(seconds / DT)):
        speeds.advance(DT)


def test_a_press_alone_is_over_after_five_time_constants() -> None:
    speeds = Speeds()
    speeds.press("forward", 1.0)
    ticks(speeds, DECAY)
    assert 0.3 < speeds.now["forward"] < 1.0 and speeds.is_moving
    ticks(speeds, 5.0 * DECAY)
    assert speeds.now["forward"] == 0.0 and not speeds.is_moving


def test_a_key_that_repeats_keeps_full_speed_and_another_one_turns_it_round() -> None:
    speeds = Speeds()
    for _ in range(30):
        speeds.press("turn", 1.0)
        speeds.advance(DT)
    assert speeds.now["turn"] > 0.9
    speeds.press("turn", -1.0)
    ticks(speeds, DECAY)
    assert speeds.now["turn"] < 0.0
