"""The programs whose time is taken do run, and a child that fails leaves a figure that is missing, not an error."""

import numpy as np
import pytest

from reference.narrow_phase import start_up
from reference.narrow_phase.start_up import ENTRIES, PREPARE, SAY, START, StartUp, measured


@pytest.mark.parametrize("program", [*(PREPARE + entries + SAY for entries in ENTRIES), START])
def test_programs_run(program: str) -> None:
    # as plain Python: what is tested is that they call what there is to call
    said, seconds = start_up._child(program, {"NUMBA_DISABLE_JIT": "1"})
    assert seconds > 0.0 and (program is START or all(float(word) >= 0.0 for word in said.split()))


def test_a_child_that_fails_is_a_missing_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(start_up, "PREPARE", "raise ValueError('no compiler')\n")
    monkeypatch.setattr(start_up, "START", "pass")
    found = measured()
    assert np.isnan(found.compile_s) and found.note == "compile: code 1: ValueError: no compiler"
    assert 0.0 < found.start_s < start_up.PATIENCE


def test_goals_are_held_or_lost_and_nan_is_lost() -> None:
    good = str(StartUp(9.0, 8.5, 1.0))
    assert "9.0 s, of the processor 8.5 s (held, goal under 10 s)" in good and "1.00 s (held, goal under 2 s)" in good
    assert "(LOST, goal under 10 s)" in str(StartUp(np.nan, np.nan, 1.0)) and "2.50 s (LOST" in str(StartUp(9.0, 8.5, 2.5))
    assert StartUp(1.0, 1.0, 2.0).as_dict()["compile_goal_s"] == start_up.COMPILE_GOAL


def test_a_child_without_end_is_a_missing_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(start_up, "PATIENCE", 0.2)
    monkeypatch.setattr(start_up, "PREPARE", "import time; time.sleep(60)\n")
    monkeypatch.setattr(start_up, "START", "import time; time.sleep(60)")
    found = measured()
    assert np.isnan(found.compile_s) and np.isnan(found.start_s)
    assert found.note.count("not done after 0.2 s; is everything compiled?") == 2
