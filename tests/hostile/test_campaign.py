"""A campaign finds bad doors, each by its bad case; all other cases are run."""

import os
import signal
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.hostile import campaign as campaigns
from tests.hostile.campaign import Batch, ask, campaign
from tests.hostile.doors import Case, Door, Unsound

BAD, COUNT = 2, 5
"""The bad case of each door, and how many it has."""


def crash() -> None:
    """End the process as native code does that writes where it may not."""
    os.kill(os.getpid(), signal.SIGSEGV)


def hang() -> None:
    """Never answer, nor hear the alarm, as a loop in native code."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGALRM})
    signal.pause()


def show_nan() -> None:
    """Give an answer that is none."""
    raise Unsound("time is nan")


DEEDS: dict[str, tuple[Callable[[], object], str]] = {
    "crash": (crash, "crash (SIGSEGV)"), "hang": (hang, "hang"), "memory": (partial(bytearray, 3 * 2**30), "memory"),
    "words": (partial(dict.__getitem__, {}, "key"), "KeyError"), "nan": (show_nan, "Unsound"),
    "end": (partial(os._exit, 7), "end of the process with 7"),
}
"""Deeds of doors that no door may do, and the kinds of their findings."""


def cases(deed: Callable[[], object], seed: int, count: int, folder: Path) -> Iterator[Case]:
    """Yield cases of which one is bad."""
    for k in range(count):
        yield Case(f"case {k}", deed if k == BAD else int)


def batch(name: str) -> Batch:
    return Batch(name, 1, COUNT, Door(name, 1.0, partial(cases, DEEDS[name][0]), reserves=name != "memory"))


def test_each_bad_case_is_found_by_number(monkeypatch: pytest.MonkeyPatch) -> None:
    # its process has to be ended from outside; how long that waits is no matter here
    monkeypatch.setattr(campaigns, "PATIENCE", 1.0)
    report = campaign([batch(name) for name in DEEDS], 2)
    assert report.asked == dict.fromkeys(DEEDS, COUNT)
    assert {door: kind for door, kind, _, _ in report.found} == {name: kind for name, (_, kind) in DEEDS.items()}
    for count, said in report.found.values():
        assert count == 1 and f"case {BAD}\n" in said and said.endswith(f"--repeat 1 {COUNT} {BAD}")


def test_one_case_can_be_asked_alone() -> None:
    (begun, (case, _, finding)) = ask(batch("nan"), BAD, BAD)
    assert begun[0] == case == BAD and finding is not None and finding.kind == "Unsound"


def test_a_door_that_crashes_every_time_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(campaigns, "CRASHES", 1)
    report = campaign([batch("crash")], 1)
    assert report.asked == {"crash": BAD + 1} and sum(count for count, _ in report.found.values()) == 1
