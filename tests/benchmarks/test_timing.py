"""Contenders take turns, each repeat begins with another one, and a slow one gets no further repeat."""

import gc
import time
from functools import partial

import pytest

from benchmarks.timing import take_turns


def test_contenders_take_turns_without_collecting_garbage() -> None:
    calls: list[str] = []
    gc.enable()

    def called(name: str) -> bool:
        calls.append(name)
        return gc.isenabled()

    found = take_turns({name: partial(called, name) for name in "abc"}, 3)
    assert "".join(calls) == "abcbcacab"
    assert found == {name: [False] * 3 for name in "abc"} and gc.isenabled()


def test_a_slow_contender_gets_no_further_repeat(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr(time, "perf_counter", lambda: clock[0])

    def takes(seconds: float) -> None:
        clock[0] += seconds

    found = take_turns({"slow": partial(takes, 0.02), "quick": partial(takes, 0.002)}, 3, 0.01)
    assert len(found["slow"]) == 1 and len(found["quick"]) == 3
