"""A few kills of the crash test, and a check that it compares enough: a changed bit of a recording is a difference."""

import random
from pathlib import Path

import numpy as np
import pytest

from runfiles import array_file
from scenarios.__main__ import main
from tests.scenarios.killed import commands, differing, of_run, run_of, tried

CHEAP = {
    "compare": ("compare", "--engine", "tracker", "--filter", "ball_drop", "--frames", "3"),
    "study": ("study", "settings", "--engine", "mujoco", "--preset", "default", "--filter", "stop_distance", "--frames", "2"),
}


@pytest.mark.parametrize(("name", "kills", "each"), [("compare", 2, 2), ("study", 1, 1)])
def test_what_a_kill_leaves_is_gone_on_with(name: str, kills: int, each: int) -> None:
    said = list[str]()
    assert tried(name, commands(True, CHEAP)[name], kills, each, random.Random(5), said.append) == []
    assert len(said) == 2 and "equal" in said[-1]


@pytest.mark.usefixtures("no_reports")
def test_one_bit_of_a_recording_is_a_difference(tmp_path: Path) -> None:
    main([*CHEAP["compare"], "--jobs", "0", "--out", str(tmp_path)])
    folder = run_of(tmp_path)
    one = of_run(folder, False)
    assert differing(one, of_run(folder, False)) == []
    (path,) = folder.glob("recordings/*")
    arrays = array_file.read(path)
    arrays["positions"][1, 0, 0] = np.nextafter(arrays["positions"][1, 0, 0], np.inf)
    with path.open("wb") as file:
        array_file.write(file, arrays)
    (folder / "recordings" / ".half.npz.1").write_bytes(b"")
    assert differing(one, of_run(folder, False)) == ["halves", f"recordings/{path.name}"]
