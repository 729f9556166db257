"""Turns are taken, poses are set before the query, what fails is out, and quartiles do not notice a single disturbance."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from reference.narrow_phase import clock
from reference.narrow_phase.cells import Cell, Mode, Sequence, sequence
from reference.narrow_phase.clock import Clocked, clocked
from reference.narrow_phase.contender import Identity

ASKED = sequence(Cell("sphere", "sphere", "apart"), "cold", 2, 3)


class Noting:
    """A contender that notes what is done to it and answers with the number of the frame."""

    def __init__(self, name: str, notes: list[str], fails: str = "") -> None:
        self.identity = Identity(name, name, True, "notes")
        self.notes, self.fails, self.frame = notes, fails, -1

    def _note(self, what: str) -> None:
        self.notes.append(f"{self.identity.name} {what}")
        if what.startswith(self.fails or "never"):
            raise RuntimeError("no such thing")

    def load(self, sequence: Sequence, mode: Mode) -> None:
        self._note("load")

    def begin(self) -> None:
        self._note("begin")

    def pose(self, frame: int) -> None:
        self.frame = frame
        self._note(f"pose {frame}")

    def ask(self) -> None:
        self._note(f"ask {self.frame}")

    def answers(self) -> NDArray[np.float64]:
        return np.full(2, float(self.frame))


def run(repeats: int, *made: Callable[[list[str]], Noting]) -> tuple[dict[str, Clocked], list[str]]:
    notes: list[str] = []
    return clocked([make(notes) for make in made], ASKED, "cold", repeats, range(0, 3, 2), {}), notes


def test_answers_come_from_the_judged_frames_and_times_from_all() -> None:
    found, _ = run(4, lambda notes: Noting("a", notes))
    assert found["a"].answers.tolist() == [[0.0, 0.0], [2.0, 2.0]]
    assert found["a"].times.shape == (4, 3) and (found["a"].times > 0.0).all()
    assert np.isnan(found["a"].call)


def test_contenders_take_turns_and_each_begins_a_round() -> None:
    _, notes = run(2, lambda n: Noting("a", n), lambda n: Noting("b", n))
    timed = [note for note in notes if note.endswith("ask 2")][2:]
    assert [note[0] for note in timed] == ["a", "b", "b", "a"]


def test_a_turn_warms_up_forgets_and_then_poses_before_every_question() -> None:
    _, notes = run(1, lambda n: Noting("a", n))
    turn = [f"a {what} {k}" for k in (0, 1) for what in ("pose", "ask")] + ["a begin"]
    turn += [f"a {what} {k}" for k in range(3) for what in ("pose", "ask")]
    assert notes[-len(turn):] == turn


def test_who_fails_is_out_and_says_why() -> None:
    found, notes = run(2, lambda n: Noting("bad", n, "ask"), lambda n: Noting("good", n))
    assert found["bad"].trouble == "RuntimeError: no such thing" and not found["bad"].times.size
    assert found["good"].times.shape == (2, 3)
    assert notes.count("bad ask 0") == 1


def test_who_takes_very_long_gets_no_further_repeat(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clock, "ENOUGH", 0.0)
    found, _ = run(5, lambda n: Noting("slow", n))
    assert found["slow"].times.shape == (1, 3)


def test_calls_are_timed_in_the_same_turns() -> None:
    notes: list[str] = []
    second = Noting("a", [])
    found = clocked([Noting("a", notes)], ASKED, "cold", 3, range(1), {"a": (second, ASKED)})
    assert found["a"].calls.shape == (3, 3) and found["a"].call > 0.0


def test_one_slow_frame_of_one_repeat_moves_no_median() -> None:
    times = np.ones((5, 4))
    times[2, 1] = 1e6
    assert Clocked(times).quartiles == (1.0, 1.0, 1.0)
