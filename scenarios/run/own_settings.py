"""A user's own settings of an engine: each adds a row to the engine's presets, and is tried before all else."""

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path

from avatarsim.errors import InvalidFile, InvalidInput, UnknownName
from avatarsim.files import read_toml
from avatarsim.running.processes import Died
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.run.accuracy import prepare
from scenarios.run.processes import side_by_side

EXAMPLE = "scenarios/settings_example.toml"
"""A file that every engine takes as it is, from the folder of the checkout."""
LONGEST = 80
"""Characters of a row's name. File systems take 255 in the name of a recording, which has the scene and the engine too."""
NAME = re.compile(rf"[A-Za-z0-9_.=-]{{1,{LONGEST}}}")
"""Names of rows: they become parts of file names, addresses and tables."""
MOST_BYTES = 2**16
"""Bytes of a file, a thousand rows; the time to read a name of many parts grows with its square."""


@dataclass(frozen=True)
class OwnSettings:
    """A row by its `name`: the engine's preset `base`, and the `options` that override it."""

    engine: str
    name: str
    base: str
    options: Mapping[str, object]


def read(path: Path, engines: Iterable[str], selected: Sequence[str] | None = None) -> tuple[OwnSettings, ...]:
    """Read a TOML file with a table [engine.name] per row: `preset` is the base ("default"), all else are options.

    Raises:
        InvalidFile: for a malformed file.
        UnknownName: for an engine that is none of `engines`.
        InvalidInput: for an engine that is not among `selected` (None: all are).
    """
    known = list(engines)
    content = read_toml(path, str(path), "a readable TOML file", MOST_BYTES)
    rows = []
    for engine, tables in content.items():
        if engine not in known:
            raise UnknownName(f"engine in {path}", engine, known)
        if selected is not None and engine not in selected:
            valid = f"one of the engines of this command: {', '.join(selected)} (--engine names others)"
            raise InvalidInput(f"engine of a table in {path}", engine, valid)
        if not isinstance(tables, dict) or not tables or not all(isinstance(entry, dict) for entry in tables.values()):
            raise InvalidFile(f"[{engine}] in {path}", tables, f"tables [{engine}.name] with settings in them")
        for name, entry in tables.items():
            if not NAME.fullmatch(name):
                valid = f"1 to {LONGEST} of letters a to z, digits, - _ . =: it becomes part of file names"
                raise InvalidFile(f"name of a row in {path}", name, valid)
            options = {key: value for key, value in entry.items() if key != "preset"}
            rows.append(OwnSettings(engine, name, str(entry.get("preset", "default")), options))
    if not rows:
        raise InvalidFile(str(path), "nothing", "a table [engine.name] for each row")
    return tuple(rows)


def _invalid(job: Job) -> tuple[str, object, str] | None:
    """Load the scene of a job; return thing, value and valid values of an InvalidInput. Any other error is left to the run."""
    with suppress(Exception), closing(opened(job.engine)) as engine:
        prepared = prepare(job)
        try:
            engine.load(prepared.scene, job.settings(engine), prepared.scenario.dt)
        except InvalidInput as error:
            return error.thing, error.value, error.valid
    return None


def check_settings(rows: Iterable[OwnSettings], scene: str, path: Path, workers: int) -> None:
    """Load a scene once with each row of the file at `path`. Raises InvalidInput for the first row that an engine refuses."""
    jobs = [Job(scene, row.engine, row.name, base=row.base, options=row.options, frames=1) for row in rows]
    # in the order of the file, whichever answers first
    for job, fault in sorted(side_by_side(_invalid, jobs, workers), key=lambda answer: jobs.index(answer[0])):
        if fault is not None and not isinstance(fault, Died):
            thing, value, valid = fault
            raise InvalidInput(f"in [{job.engine}.{job.preset}] of {path}: {thing}", value, valid)
