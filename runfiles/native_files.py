"""Where a scene in a simulator's own words lies in a run's folder: MJCF, calls, and what an engine was told in every step."""

from pathlib import Path

from runfiles.naming import stem

FOLDER = "native"
"""Where these files lie in a run's folder."""
STEPS = "steps.npz"
"""How the names of files end that have what an engine was told in every step."""


def replay(engine: str) -> str:
    """Return the path, below a run's folder, of the program that plays the steps of an engine."""
    return f"{FOLDER}/replay_{engine}.py"


def steps_written(folder: Path, scene: str, run: str, seed: int) -> tuple[str, ...]:
    """Paths, below a run's `folder`, of those two files; none where there are none."""
    engine, _, preset = run.partition("/")
    names = f"{FOLDER}/{stem(scene, engine, preset, seed)}.{STEPS}", replay(engine)
    return names if all((folder / name).exists() for name in names) else ()


def written(folder: Path, scene: str, run: str, seed: int) -> str:
    """Path, below a run's `folder`, of what was written for that scene, run and seed; "" if nothing was."""
    engine, _, preset = run.partition("/")
    found = sorted((folder / FOLDER).glob(f"{stem(scene, engine, preset, seed)}.*.gz"))
    return f"{FOLDER}/{found[0].name}" if found else ""
