"""BVH files: what is read, what is guessed and said, and the same file again."""

from pathlib import Path

import numpy as np
import pytest

from avatarsim.assets.motions.bvh import read_bvh
from tests.assets.motions.files import WALKER, bvh


@pytest.fixture
def walker(tmp_path: Path) -> Path:
    path = tmp_path / "walker.bvh"
    path.write_text(bvh(WALKER, np.random.default_rng(1).normal(0.0, 10.0, (5, 30)) + [0, 90, 0, *[0] * 27]))
    return path


def test_numbers_come_back_bit_for_bit(walker: Path) -> None:
    file = read_bvh(walker)
    model = file.model()
    again = walker.with_name("again.bvh")
    again.write_bytes(file.written(file.motion(model), model))
    assert (read_bvh(again).recording.values == file.recording.values).all()
