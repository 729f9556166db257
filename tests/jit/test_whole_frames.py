"""Whole frames compiled and as plain Python: equal to the last bit, and in Python without one invalid operation."""

import os
import subprocess
import sys

from tests.jit.whole_frames import lines


def test_compiled_frames_are_those_of_plain_python() -> None:
    plain = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-W", "error", "-m", "tests.jit.whole_frames"]
    ran = subprocess.run(command, env=plain, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.splitlines() == lines()
