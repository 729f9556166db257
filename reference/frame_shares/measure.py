"""Runs a scene with the frame's twin in place and reads the clocks frame by frame."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine
from reference.frame_shares.cycles import per_microsecond, spent
from reference.frame_shares.twins import NAMES, TWINS

Array = NDArray[np.float64]

_made: dict[str, object] = {}
"""Twins by method, compiled once per process."""

WARM = 3
"""Frames of a first run, in which everything is compiled and loaded."""


@dataclass(frozen=True, eq=False)
class Shares:
    """Time (F,) [us] of each frame by part (`twins.NAMES`), and the state's hash at the end."""

    us: dict[str, Array]
    state_hash: str

    def share(self, name: str) -> float:
        """Share [%] of a part in all frames together."""
        whole = float(self.us["whole"].sum())
        return 100.0 * float(self.us[name].sum()) / whole if whole > 0.0 else float("nan")


def measured(scene: Scene, samples: Sequence[TrackerSample], dt: float, method: str, seed: int = 0, repeats: int = 3) -> Shares:
    """The parts of every frame, least of `repeats` runs. Raises InvalidInput where there is no cycle counter."""
    module, name, make = TWINS[method]
    original = getattr(module, name)
    if method not in _made:
        _made[method] = make()
    setattr(module, name, _made[method])
    try:
        _run(scene, samples[:WARM], dt, method, seed)
        runs = [_run(scene, samples, dt, method, seed) for _ in range(repeats)]
    finally:
        setattr(module, name, original)
    # the run of a frame that took least is taken whole, so that its parts belong together
    every = np.array([cycles for cycles, _ in runs])
    best = every[every[:, :, NAMES.index("whole")].argmin(axis=0), np.arange(every.shape[1])]
    rate = per_microsecond()
    return Shares({part: best[:, k] / rate for k, part in enumerate(NAMES)}, runs[0][1])


def _run(scene: Scene, samples: Sequence[TrackerSample], dt: float, method: str, seed: int) -> tuple[NDArray[np.int64], str]:
    engine = AvatarsimEngine()
    shown = engine.load(scene, Settings(method, seed=seed), dt)
    cycles = np.zeros((len(samples), len(NAMES)), dtype=np.int64)
    for k, sample in enumerate(samples):
        spent[:] = 0
        shown = engine.advance(sample, dt)
        cycles[k] = spent[: len(NAMES)]
    engine.close()
    return cycles, shown.state_hash()
