"""No scene, seed or frame time from 1e-6 to 0.2 s gives a number that is none, an overlap, or an endless loop.

An endless loop is seen by this file never coming to its end.
"""

import zlib

import numpy as np
import pytest

from avatarsim.engine import Settings
from reference.judging.judge import Judge
from runfiles.naming import GATED
from scenarios import catalog
from scenarios.engines import opened
from scenarios.scenario import REFUSAL
from scenarios.studies.hard_cases.variation import Variation, varied

SHORTEST, LONGEST = 1e-6, 0.2
"""[s]"""
FRAMES = 4
"""Frames at each time: faults at a frame time come in its first frames, or where the user meets something."""
DRAWS = 1
"""Frame times drawn for each scene between the two ends."""
NAMES = [name for name, scenario in catalog.scenarios().items() if not scenario.expects.get(REFUSAL)]


def frame_times(name: str) -> list[tuple[float, int]]:
    """Return (frame time [s], seed): both ends, and some between, other ones for each scene."""
    random = np.random.default_rng(zlib.crc32(name.encode()))
    drawn = np.exp(random.uniform(np.log(SHORTEST), np.log(LONGEST), DRAWS)).tolist()
    return [(dt, int(random.integers(100))) for dt in (SHORTEST, *drawn, LONGEST)]


@pytest.mark.parametrize("name", NAMES)
def test_frames_of_any_length_end_in_numbers(name: str) -> None:
    scenario = catalog.get(name).as_run(False)
    judge = Judge(scenario.build())
    for dt, seed in frame_times(name):
        case = varied(scenario, FRAMES * dt, Variation(seed=seed, user=seed, dt=dt))
        engine = opened(GATED[0])
        records = [engine.load(case.scene, Settings(seed=seed), case.dt)]
        records += [engine.advance(sample, case.dt) for sample in case.samples]
        engine.close()
        assert len(records) == FRAMES + 1
        for record in records:
            shown = record.shown
            for array in (shown.positions, shown.orientations, shown.velocities, shown.angular_velocities, record.angles):
                assert np.isfinite(array).all(), (dt, seed)
        assert not judge.overlaps(shown.positions, shown.orientations).deepest > 1e-6, (dt, seed)
