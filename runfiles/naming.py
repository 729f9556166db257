"""Names of engines, settings and scenes in the rows and files of a run, for its writer and its readers alike."""

GATED = ("avatarsim", "default")
"""The engine and preset that carry bounds unless `check --engine` names another."""
BASELINE = "tracker"
"""The engine without contact handling: its overlap is how large the problem is."""
COMPILED = "compiled: "
"""How the names of settings begin that are no choice of ours but what became of those in a scene, in numbers."""
TUNED = "tuned"
"""The preset beside which settings stand that are better in something else."""
UNSEEN_PREFIX = "unseen_"
"""How the names of scenes begin whose motions nothing was tuned for."""
CROWD_PREFIX = "crowd_"
"""How the names of scenes begin in which random bodies are drawn by a seed, which the name ends with."""
OWN_PREFIX = "own_"
"""How the names of scenes begin that a user brings as files."""


def stem(scenario: str, engine: str, preset: str, seed: int) -> str:
    """Name, without ending, of the files that a run keeps of one engine and preset in one scene with one seed."""
    return f"{scenario}.{engine}.{preset}.{seed}"
