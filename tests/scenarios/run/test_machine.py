"""Facts of the machine, and cases in which it gives none."""

import math
from pathlib import Path

import pytest

from scenarios.run.machine import LOOPS, Meter, Pace, busy_seconds, clock


def test_the_clock_is_that_of_the_fastest(tmp_path: Path) -> None:
    (tmp_path / "cpuinfo").write_text("model name\t: Abacus\ncpu MHz\t\t: 2445.4\ncpu MHz\t\t: 3100.6\n")
    (tmp_path / "most").write_text("3500000\n")
    assert clock(tmp_path / "cpuinfo", tmp_path / "most") == {"mhz": 3101, "mhz_max": 3500}


@pytest.mark.parametrize("text", [None, "", "cpu MHz : fast\n", "cpu MHz\n"])
def test_a_clock_that_nothing_tells_is_none(tmp_path: Path, text: str | None) -> None:
    if text is not None:
        (tmp_path / "cpuinfo").write_text(text)
        (tmp_path / "most").write_text(text)
    assert clock(tmp_path / "cpuinfo", tmp_path / "most") == {"mhz": None, "mhz_max": None}


def test_busy_time_is_all_but_idle_and_waiting(tmp_path: Path) -> None:
    (tmp_path / "stat").write_text("cpu  100 20 30 4000 500 6 7 800 90 9\ncpu0 1 2 3\n")
    (tmp_path / "more").write_text("cpu  200 20 30 9000 900 6 7 800 95 9\ncpu0 1 2 3\n")
    before, after = busy_seconds(tmp_path / "stat"), busy_seconds(tmp_path / "more")
    empty = tmp_path / "none"
    empty.write_text("cpu0 1 2\n")
    assert after > before > 0.0
    # 100 ticks of 963
    assert (after - before) / before == pytest.approx(100 / 963)
    assert math.isnan(busy_seconds(tmp_path / "absent")) and math.isnan(busy_seconds(empty))


def metered(busy: list[float], now: list[float]) -> Meter:
    readings, times = iter(busy), iter(now)
    meter = Meter(lambda: next(readings), lambda: next(times))
    for _ in range(len(now) // 2):
        with meter.running():
            pass
    return meter


def test_other_work_is_what_is_busy_beside_one_thread() -> None:
    # 10 s and 2 s long; of 14.4 s of work 12 s are meant
    meter = metered([100.0, 112.0, 200.0, 202.4], [0.0, 10.0, 50.0, 52.0])
    assert meter.seconds == 12.0 and meter.others == pytest.approx(0.2)


def test_work_of_others_is_never_negative_and_may_be_unknown() -> None:
    assert metered([0.0, 0.9], [0.0, 1.0]).others == 0.0
    assert metered([math.nan, 0.9, 1.0, 2.0], [0.0, 1.0, 2.0, 3.0]).others is None
    assert Meter().others is None


def test_a_core_is_waited_for_until_it_is_fast_again() -> None:
    loops, now = [100.0] * LOOPS + [170.0, 160.0, 110.0, 80.0, 110.0, 90.0], iter(range(1000))
    given = iter(loops)
    pace = Pace(lambda: next(given), lambda: 1e-3 * next(now))
    assert pace.wait() and next(given) == 80.0, "slow loops, until one is fast"
    assert pace.wait() and next(given) == 90.0, "as fast as 100, within the noise"


def test_waits_in_vain_become_shorter_and_long_again() -> None:
    speed, now = [100.0], [0.0]

    def passing() -> float:
        now[0] += 1e-3
        return now[0]

    pace = Pace(lambda: speed[0], passing)
    speed[0], waits = 170.0, []
    for _ in range(4):
        begun = now[0]
        assert not pace.wait()
        waits.append(now[0] - begun)
    assert waits == pytest.approx([0.3, 0.15, 0.075, 0.0375], abs=3e-3)
    speed[0] = 100.0
    assert all(pace.wait() for _ in range(4)) and pace.patience == pytest.approx(0.3)
