"""Ladder of time steps that every engine runs in every scene: without it none of its settings is known as the cheapest."""

RATES = (120, 240, 480, 1920, 3840)
"""Steps a second, coarsest first; between the third and the fourth lie the presets."""
COARSE = 480
"""The last of them that is coarser than a preset: these cost less than the preset and run before all else."""
BASE = "tuned"
"""The preset that is stepped so."""
NAMES = {f"{BASE} dt=1/{rate}": rate for rate in RATES}
"""Name of a setting -> its steps a second."""


def is_rung(name: str) -> bool:
    """Return whether a setting of that name is a rung."""
    return name in NAMES


def is_coarse(name: str) -> bool:
    """Return whether it is one of the coarse rungs."""
    return NAMES.get(name, COARSE + 1) <= COARSE
