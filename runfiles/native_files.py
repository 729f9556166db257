"""Where a scene in a simulator's own words lies in a run's folder: MJCF, calls, and what an engine was told in every step."""

from pathlib import Path

from runfiles.naming import stem

FOLDER = "native"
"""Where these files lie in a run's folder."""
STEPS = "steps.npz"
"""How the names of files end that have what an engine was told in every step."""
REPLAY = "replay.py"
"""The program that plays them."""


def steps_written(folder: Path, scene: str, run: str, seed: int) -> tuple[str, ...]:
    """Paths, below a run's `folder`, of those two files; none where there are none."""
    engine, _, preset = run.partition("/")
    name = f"{FOLDER}/{stem(scene, engine, preset, seed)}.{STEPS}"
    return (name, f"{FOLDER}/{REPLAY}") if (folder / name).exists() else ()


def written(folder: Path, scene: str, run: str, seed: int) -> str:
    """Path, below a run's `folder`, of what was written for that scene, run and seed; "" if nothing was."""
    engine, _, preset = run.partition("/")
    found = sorted((folder / FOLDER).glob(f"{stem(scene, engine, preset, seed)}.*.gz"))
    return f"{FOLDER}/{found[0].name}" if found else ""
