"""Near pairs: all compared at once against sorting along an axis, and against every pair queried by itself."""

import numpy as np
import pytest

from reference.judging import near as judge_near
from reference.judging.near import by_sorting, near_pairs


def boxes(seed: int, states: int, pieces: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    centres = random.uniform(-1.0, 1.0, (states, pieces, 3))
    halves = random.uniform(0.1, 0.5, (states, pieces, 3))
    may_meet = random.random((pieces, pieces)) < 0.7
    may_meet = (may_meet | may_meet.T) & ~np.eye(pieces, dtype=bool)
    return may_meet, centres - halves, centres + halves


def one_by_one(may_meet: np.ndarray, low: np.ndarray, high: np.ndarray, reach: float) -> set[tuple[int, int]]:
    return {
        (a, b) for a in range(len(low)) for b in range(a + 1, len(low))
        if may_meet[a, b] and all(low[a, k] <= high[b, k] + reach and low[b, k] <= high[a, k] + reach for k in range(3))
    }


@pytest.mark.parametrize("reach", [0.0, 0.1, 10.0])
@pytest.mark.parametrize("most", [0, 3000])
def test_each_way_finds_every_near_pair_once(reach: float, most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(judge_near, "MAX_PAIRS", most)
    monkeypatch.setattr(judge_near, "AT_ONCE", 200)
    monkeypatch.setattr(judge_near, "CROWD_AT_ONCE", 4)
    may_meet, low, high = boxes(5, 6, 12)
    found = near_pairs(may_meet, low, high, reach)
    assert (np.diff(found.state) >= 0).all()
    for k in range(6):
        _, first, second = found.at(found.state == k)
        pairs = [(min(a, b), max(a, b)) for a, b in zip(first.tolist(), second.tolist(), strict=True)]
        assert len(pairs) == len(set(pairs))
        assert set(pairs) == one_by_one(may_meet, low[k], high[k], reach) and pairs


def test_boxes_that_touch_are_near_and_no_state_asks_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    may_meet = np.array([[False, True], [True, False]])
    low, high = np.array([[[0.0, 0, 0], [1.0, 0, 0]]]), np.array([[[1.0, 1, 1], [2.0, 1, 1]]])
    assert len(near_pairs(may_meet, low, high, 0.0).first) == 1
    assert len(by_sorting(may_meet, low[0], high[0])[0]) == 1
    for most in (0, 3000):
        monkeypatch.setattr(judge_near, "MAX_PAIRS", most)
        assert [len(column) for column in near_pairs(may_meet, low[:0], high[:0], 0.0)] == [0, 0, 0]


def test_a_state_without_numbers_hides_no_other() -> None:
    may_meet, low, high = boxes(5, 6, 12)
    low[2], high[4, 3] = np.nan, np.nan
    found = near_pairs(may_meet, low, high, 0.0)
    for k in range(6):
        _, first, second = found.at(found.state == k)
        assert set(zip(first.tolist(), second.tolist(), strict=True)) == one_by_one(may_meet, low[k], high[k], 0.0)
    assert not (found.state == 2).any()
