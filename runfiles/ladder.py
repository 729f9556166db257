"""The ladder of time steps that every rival is asked in every scene: without it none of its settings is known as the cheapest."""

RATES = (120, 240, 480, 1920, 3840)
"""Steps a second, coarsest first; between the third and the fourth lie the presets."""
COARSE = 480
"""The last of them that is coarser than a preset: these cost less than the preset and are asked before all else."""
BASE = "tuned"
"""The preset that is stepped so."""
NAMES = {f"{BASE} dt=1/{rate}": 1.0 / rate for rate in RATES}
"""Name of a setting -> its step [s]."""


def step_of(name: str) -> float | None:
    """The step [s] of a setting that is a rung of the ladder; None for any other."""
    return NAMES.get(name)


def is_rung(name: str) -> bool:
    """Whether a setting of that name is a rung."""
    return name in NAMES


def is_coarse(name: str) -> bool:
    """Whether it is one of the coarse rungs."""
    return NAMES.get(name, 0.0) >= (1.0 - 1e-9) / COARSE
