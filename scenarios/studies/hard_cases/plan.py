"""Cases and changes of the study: each change alone, in steps, and all together by a seeded Latin hypercube."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from scenarios.studies.hard_cases.variation import Variation

CASES = {
    "stack_ten": 0.6, "heavy_on_light": 0.6, "painleve": 0.6, "newton_cradle_touching": 0.6, "tumbling_box": 0.6,
    "non_convex": 0.6, "tunnelling": 1.0 / 3.0, "squeeze": 1.2, "hand_in_bowl": 1.2, "arms_through_chest": 0.6,
}
"""Scenes and how many seconds of them: towers, ambiguous impacts, jamming, tumbling, hollow bodies, bullets, a body caught
between hand and wall, a hand of many parts in a bowl, limbs of a whole avatar in one another."""
STARTS = (1e-9, 1e-7, 1e-5, 1e-3)
"""[m]"""
SEEDS = (1, 2)
USERS = (1, 2)
TIMES = (1.0 / 1000.0, 1.0 / 240.0, 1.0 / 30.0, 1.0 / 15.0)
"""[s]; a sixtieth is the plain case."""
SCALES = (1e-3, 1e-1, 1e1, 1e3)
DISTANCES = (1e1, 1e3, 1e5)
"""[m] of a world of size 1."""
STEPS = (0.5, 2.0)
"""Solver steps in steps of the preset; another frame time hardly changes them, as engines cut a frame into steps of their own."""
TOGETHER, SEED = 12, 20
"""Number of draws that change all at once, and the seed of the hypercube."""


@dataclass(frozen=True)
class Trial:
    """A change of one kind, and its level as tables write it; "" for none."""

    kind: str
    level: str
    change: Variation

    @property
    def name(self) -> str:
        """Name of the change."""
        return f"{self.kind} {self.level}".strip()


def alone() -> list[Trial]:
    """Return the plain case and every change for itself."""
    trials = [Trial("", "", Variation())]
    trials += [Trial("start", f"{start:g} m", Variation(start=start)) for start in STARTS]
    trials += [Trial("seed", str(seed), Variation(seed=seed)) for seed in SEEDS]
    trials += [Trial("user", str(user), Variation(user=user)) for user in USERS]
    trials += [Trial("frame time", f"1/{1.0 / dt:.0f} s", Variation(dt=dt)) for dt in TIMES]
    trials += [Trial("solver step", f"{step:g} times", Variation(step=step)) for step in STEPS]
    trials += [Trial("size", f"{scale:g}", Variation(scale=scale)) for scale in SCALES]
    trials += [Trial("distance", f"{far:g} m", Variation(far=far)) for far in DISTANCES]
    return trials


def together(count: int = TOGETHER, seed: int = SEED) -> list[Trial]:
    """Return all changes at once but for the user's motion, whose outcomes could not be compared: one draw per row and column."""
    low = np.array([STARTS[0], 0.0, TIMES[0], SCALES[0], DISTANCES[0]])
    high = np.array([STARTS[-1], 100.0, TIMES[-1], SCALES[-1], DISTANCES[-1]])
    logarithmic = np.array([True, False, True, True, True])
    floor = np.where(logarithmic, np.log(np.where(low > 0.0, low, 1.0)), low)
    roof = np.where(logarithmic, np.log(high), high)
    draws = floor + (roof - floor) * qmc.LatinHypercube(5, rng=np.random.default_rng(seed)).random(count)
    trials = []
    for k, draw in enumerate(np.where(logarithmic, np.exp(draws), draws)):
        start, engine_seed, dt, scale, far = draw.tolist()
        trials.append(Trial("together", f"draw {k}", Variation(start, int(engine_seed), 0, dt, scale, far)))
    return trials


def trials(count: int = TOGETHER) -> list[Trial]:
    """Return everything that is tried on every case."""
    return [*alone(), *together(count)]
