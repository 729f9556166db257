"""Names of engines, settings and scenes in the rows and files of a run, for its writer and its readers alike."""

GATED = ("avatarsim", "default")
"""The engine and preset that carry bounds unless `check --engine` names another."""
BASELINE = "tracker"
"""The engine without contact handling: its overlap is the size of the problem."""
COMPILED = "compiled: "
"""Beginning of the names of settings that an engine's compiler made of ours in a scene, in numbers."""
TUNED = "tuned"
"""The preset with which settings are compared that are better in something else."""
UNSEEN_PREFIX, CROWD_PREFIX, OWN_PREFIX = "unseen_", "crowd_", "own_"
"""Beginnings of the names of scenes: of motions that nothing was tuned for, of bodies drawn by a seed, of files of a user."""


def stem(scenario: str, engine: str, preset: str, seed: int) -> str:
    """Return the name, without ending, of the files of one engine and preset in one scene with one seed."""
    return f"{scenario}.{engine}.{preset}.{seed}"
