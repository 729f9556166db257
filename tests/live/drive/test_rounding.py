"""Drags of nearly equal goals end in nearly equal postures, and those of other BLAS kernels too."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.live.drive.stages_driven import driver, ticks

ROOT = Path(__file__).parents[3]

DRAGS = [
    ("gallery", "human/left_hand", (-0.5, 0.4, 1.2)), ("gallery", "human/left_hand", (3.0, 1.0, 1.2)),
    ("gallery", "human/right_hand", (-3.5, -0.4, 0.3)), ("gallery", "human/right_wrist", (-2.0, 0.5, 1.0)),
    ("gallery", "human/head", (-2.2, 0.0, 4.0)), ("gallery", "human/left_foot", (-2.0, 0.3, 0.5)),
    ("hand", "hand/thumb3", (1.0, 1.0, 0.2)), ("hand", "hand/index3", (0.4, 0.3, 1.3)),
]

PRINTED = """
from tests.live.drive.test_rounding import dragged
print(*dragged("gallery", "human/left_hand", (-0.5, 0.4, 1.2)).ravel().tolist())
"""


def dragged(name: str, handle: str, goal: tuple[float, ...]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Postures of four seconds in which a link is dragged, a row each."""
    one = driver(name)
    one.drag(handle, goal)
    return np.array([np.concatenate([s.positions.ravel(), s.rotations.ravel(), s.angles]) for s in ticks(one, 240)])


@pytest.mark.parametrize(("name", "handle", "goal"), DRAGS)
def test_a_goal_that_differs_in_its_last_bits_leads_to_the_same_postures(
    name: str, handle: str, goal: tuple[float, float, float]
) -> None:
    shown, rng = dragged(name, handle, goal), np.random.default_rng(1)
    for size, bound in ((1e-13, 1e-9), (1e-9, 1e-5)):
        moved = np.array(goal) * (1.0 + size * rng.uniform(-1.0, 1.0, 3))
        assert np.abs(dragged(name, handle, tuple(moved.tolist())) - shown).max() < bound


def test_another_kernel_of_the_linear_algebra_library_leads_to_the_same_postures() -> None:
    # read when numpy is loaded; every x86 has this core type, and other machines and libraries ignore the variable
    env = {**os.environ, "OPENBLAS_CORETYPE": "Prescott"}
    done = subprocess.run([sys.executable, "-c", PRINTED], cwd=ROOT, env=env, capture_output=True, text=True, check=True)
    other = np.array([float(word) for word in done.stdout.split()])
    assert np.abs(other - dragged("gallery", "human/left_hand", (-0.5, 0.4, 1.2)).ravel()).max() < 1e-9
