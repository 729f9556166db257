"""The command that times the frames of leaps: places are drawn far enough to be leaps, and its frames are those of leaps."""

import numpy as np
import pytest

from avatarsim.engine import Settings
from scenarios.engines import GATED, opened
from scenarios.leap_times import BEYOND, MOVES, leapt, main
from scenarios.scenario import RENDERED
from scenarios.unseen.rooms import ROOMS


def test_a_drawn_leap_is_one_to_the_engine_and_ends_in_or_just_outside_the_rectangle() -> None:
    room = ROOMS[1]
    scene, random, engine = room.build(), np.random.default_rng(3), opened(GATED[0])
    for _ in range(5):
        sample = leapt(scene, room, random)
        place = sample.positions[0, :2]
        assert (place >= np.subtract(room.low, BEYOND)).all() and (place <= np.add(room.high, BEYOND)).all()
        assert np.linalg.norm(place - scene.first_sample.positions[0, :2]) > MOVES
        engine.load(scene, Settings(GATED[1]), RENDERED)
        engine.advance(scene.first_sample, RENDERED)
        assert engine.advance(sample, RENDERED).counts["leaps"] == 1
    engine.close()


def test_a_line_per_room_with_and_without_searches(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--leaps", "1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[2] for line in lines] == 2 * [room.name for room in ROOMS]
    assert all(float(line.split()[-2]) > 0.0 for line in lines)
