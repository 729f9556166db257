"""Places of a scene in a simulator's own words in a run's folder: MJCF, calls, and the inputs of an engine in every step."""

from pathlib import Path

from runfiles.naming import stem

FOLDER, STEPS = "native", "steps.npz"
"""Folder of these files, and ending of the names of those with the inputs of every step."""


def replay(engine: str) -> str:
    """Return the path, below a run's folder, of the program that plays the steps of an engine."""
    return f"{FOLDER}/replay_{engine}.py"


def steps_written(folder: Path, scene: str, run: str, seed: int) -> tuple[str, ...]:
    """Return the paths, below a run's `folder`, of the steps and their program; none where there are none."""
    engine, _, preset = run.partition("/")
    names = f"{FOLDER}/{stem(scene, engine, preset, seed)}.{STEPS}", replay(engine)
    return names if all((folder / name).exists() for name in names) else ()


def written(folder: Path, scene: str, run: str, seed: int) -> str:
    """Return the path, below a run's `folder`, of the file for that scene, run and seed; "" without one."""
    engine, _, preset = run.partition("/")
    paths = sorted((folder / FOLDER).glob(f"{stem(scene, engine, preset, seed)}.*.gz"))
    return f"{FOLDER}/{paths[0].name}" if paths else ""
