"""Checkpoint and restart of runs: which folders are a run, what its plan is, and how a run that was stopped goes on.

The plan is written before anything is measured. A command that resumes a run has to ask for all of its plan, and may ask for
more: rows of what it did not ask for would be lost with the results.json that it writes.
"""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from os.path import isdir
from pathlib import Path

from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.files import read_json
from runfiles.files import plain, write_json
from runfiles.published import MOST_BYTES, SCHEMA_VERSION
from scenarios.job import Job

PLAN, PLAN_VERSION = "plan.json", 1
"""File of a run's plan, and its layout."""
WRITTEN = "one that this version wrote; run again"
"""What a plan has to be."""


def earlier_run(folder: Path, command: str) -> Path:
    """`folder`, resolved, once it has proved to be a run of `command` that this harness wrote.

    Raises InvalidInput or InvalidFile: files are written there, and a folder of something else may not be taken for a run."""
    # by os.path, which takes names that are too long for the system as names of nothing
    if not isdir(folder):
        raise InvalidInput("--resume", str(folder), "the folder of an earlier run")
    path = folder / "results.json"
    try:
        found = read_json(path, f"results {path}", "the whole file of a run", MOST_BYTES)
    except InvalidFile as error:
        why = f"the folder of an earlier run, with its results.json ({error.value})"
        raise InvalidInput("--resume", str(folder), why) from error
    version = found.get("schema_version") if isinstance(found, dict) else None
    if version != SCHEMA_VERSION:
        raise InvalidFile(f"schema_version of {path}", version, f"{SCHEMA_VERSION}; run again")
    origin = found.get("provenance") if isinstance(found, dict) else None
    words = str(origin.get("command", "")).split() if isinstance(origin, dict) else []
    # python -m scenarios COMMAND ...
    wrote = words[3] if words[:3] == ["python", "-m", "scenarios"] and len(words) > 3 else None
    if wrote != command:
        raise InvalidInput("--resume", str(folder), f"a run of the same command, {command}; this one was written by {wrote}")
    return folder.resolve()


def has_ended(folder: Path) -> bool:
    """Whether a run that was taken by `earlier_run` has come to its end."""
    found = read_json(folder / "results.json", f"results of {folder}", "the whole file of a run", MOST_BYTES)
    return isinstance(found, dict) and found.get("exit_code") is not None


def described(job: Job) -> Mapping[str, object]:
    """All that decides what a job shows, as JSON holds it."""
    return {str(name): plain(value) for name, value in asdict(job).items()}


def write_plan(folder: Path, words: Sequence[str], jobs: Sequence[Job]) -> None:
    """Leave the plan of a run in its folder: `words` of the command line, and its jobs."""
    runs = [described(job) for job in jobs]
    write_json(folder / PLAN, {"schema_version": PLAN_VERSION, "words": list(words), "runs": runs})


def check_plan(folder: Path, jobs: Sequence[Job]) -> None:
    """Raise InvalidInput where the plan of the run in `folder` has what is not among `jobs`: another scene, engine, preset or
    seed, another length, other settings under one name. That would be lost."""
    path = folder / PLAN
    found = read_json(path, f"plan {path}", WRITTEN, MOST_BYTES)
    if not isinstance(found, dict) or found.get("schema_version") != PLAN_VERSION or not isinstance(found.get("words"), list):
        raise InvalidFile(f"plan {path}", "of another layout", WRITTEN)
    runs = found.get("runs")
    if not isinstance(runs, list) or not all(isinstance(run, dict) for run in runs):
        raise InvalidFile(f"runs of plan {path}", "no list of objects", WRITTEN)
    asked = [described(job) for job in jobs]
    if left := [run for run in runs if run not in asked]:
        more = f" and {len(left) - 1} others" if len(left) > 1 else ""
        again = command_to_go_on(folder, [str(word) for word in found["words"]])
        valid = (f"a run of which all is asked for, or more; this one has {_told(left[0], asked)}{more}, which this command does "
                 f"not ask for. `{again}` goes on with it; without --resume this command begins a run of its own")
        raise InvalidInput("--resume", str(folder), valid)


def _told(run: Mapping[str, object], asked: Sequence[Mapping[str, object]]) -> str:
    """A run in words; where one of the same name is asked for, in what they differ."""
    names = ("scenario", "engine", "preset", "seed")
    said = f"{run.get('scenario')} in {run.get('engine')}/{run.get('preset')}, seed {run.get('seed')}"
    same = next((one for one in asked if all(one[name] == run.get(name) for name in names)), None)
    if same is None:
        return said
    return f"{said}, with {', '.join(f'{name} {run.get(name)}' for name in same if same[name] != run.get(name))}"


def command_to_go_on(folder: Path, words: Sequence[str]) -> str:
    """The command line that goes on with the run in `folder`, which was begun with `words`, quoted for a shell."""
    kept, skip = list[str](), False
    for word in words:
        if not skip and word != "--resume" and not word.startswith("--resume="):
            kept.append(word)
        skip = not skip and word == "--resume"
    return shlex.join(["python", "-m", "scenarios", *kept, "--resume", str(folder)])


def how_to_go_on(folder: Path, words: Sequence[str]) -> str:
    """One sentence for the user: how a run that was stopped goes on."""
    return f"stopped; what was finished is kept, and `{command_to_go_on(folder, words)}` goes on from there"
