"""Studies: questions about a run beyond its scenes. Each leaves one file of rows, `NAME.csv`, in the folder of the run.

A comparison carries them out in their short form, `python -m scenarios study` in their long one, which resumes where it
was stopped.
"""

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from avatarsim.errors import AvatarsimError, described
from avatarsim.running.processes import PATIENCE, Died, Workers
from runfiles.files import write_text
from runfiles.metrics import unit
from runfiles.table import STUDIED, Row, Status, csv_text
from scenarios.job import Outcome
from scenarios.run.own_settings import OwnSettings
from scenarios.run.processes import side_by_side
from scenarios.run.progress import Progress, print_done
from scenarios.run.timing import Clocked
from scenarios.scenario import Scenario
from scenarios.studies.checkpoint import Checkpoint, Entry

Task = TypeVar("Task")


@dataclass(frozen=True)
class Request:
    """Run that a study is about.

    folder     of the run
    scenarios  by name
    presets    of each engine that took part and can be opened
    workers    processes that run side by side, or a cluster
    seed       of motions and engines
    full       full lengths
    outcomes, clocked  results of both passes of the run, by the stem of the job
    checkpoints  folder of the long form; None for the short one
    own        settings of the reader's own
    frames     most frames of a scene; None for all
    """

    folder: Path
    scenarios: Mapping[str, Scenario]
    presets: Mapping[str, tuple[str, ...]]
    workers: Workers
    seed: int = 0
    full: bool = False
    outcomes: Mapping[str, Outcome] = field(default_factory=dict)
    clocked: Mapping[str, Clocked] = field(default_factory=dict)
    checkpoints: Path | None = None
    own: tuple[OwnSettings, ...] = ()
    frames: int | None = None

    @property
    def long(self) -> bool:
        """Return True if the long form is requested."""
        return self.checkpoints is not None

    def checkpoint(self, study: str) -> Checkpoint:
        """Return the checkpoint of a study: in a file in its long form only, since a comparison's figures are all its own."""
        return Checkpoint(None if self.checkpoints is None else self.checkpoints / f"{study}.jsonl")


@dataclass(frozen=True)
class Study:
    """One question.

    name  of the study and of its file
    ask   carries it out: returns its rows, and a sentence for each thing that could not be done
    usual whether the long form takes a scene unless others are named
    """

    name: str
    ask: Callable[[Request], tuple[Sequence[Row], Sequence[str]]]
    usual: Callable[[Scenario], bool] = bool

    def carry_out(self, request: Request) -> tuple[Sequence[Row], Sequence[str]]:
        """Carry it out and write its file, whole or not at all; none where it has no rows."""
        rows, troubles = self.ask(request)
        if rows:
            write_text(request.folder / f"{self.name}.csv", csv_text(rows, STUDIED))
        return rows, troubles


def in_turn(studies: Sequence[Study], request: Request) -> list[str]:
    """Carry out all studies; a fault of one costs neither the run nor the others.

    Returns:
        A sentence per trouble, each with the name of its study.

    Raises:
        KeyboardInterrupt: when the run is stopped.
    """
    troubles = []
    for study in studies:
        begun, count = time.monotonic(), "failed"
        try:
            rows, missing = study.carry_out(request)
            count = f"{len(rows)} rows" if rows else ""
            troubles += [f"{study.name}: {trouble}" for trouble in missing]
        except AvatarsimError as error:
            troubles.append(f"{study.name}: {error}")
        except Exception as error:
            # a fault in a study must cost neither the verdict nor the report
            troubles.append(f"{study.name}: {described(error)}")
        print_done(study.name, count, time.monotonic() - begun, sys.stderr)
    return troubles


def answers(
    function: Callable[[Task], Entry], tasks: Mapping[str, Task], request: Request, checkpoint: Checkpoint, name: str,
    tidy: Callable[[Task], bool], patience: float = PATIENCE, late: Status = "crashed",
) -> Iterator[tuple[str, Entry]]:
    """Yield the answer to each task by its key: those of the checkpoint first, then new ones as they come, which it keeps.

    Args:
        function: answers one task, in a process of its own unless the task is `tidy`.
        patience: longest time [s] without an answer, after which the state of a task is `late`.

    A task whose process ended without an answer has crashed. That is not kept, nor is a task that was not measured: it may be
    the machine's fault.
    """
    missing = {key: task for key, task in tasks.items() if checkpoint.get(key) is None}
    yield from ((key, checkpoint.known[key]) for key in tasks if key not in missing)
    keys = {id(task): key for key, task in missing.items()}
    with Progress(name, len(missing), sys.stderr, part=True) as progress:
        for task, answer in side_by_side(function, list(missing.values()), request.workers, tidy, patience):
            key = keys[id(task)]
            if isinstance(answer, Died):
                state = late if "no answer" in str(answer) else "crashed"
                answer = {"state": state, "note": str(answer), "frames": 0, "values": {}}
            elif answer["state"] != "not-measured":
                checkpoint.put(key, answer)
            progress.step(name)
            yield key, answer


@dataclass(frozen=True)
class Head:
    """Columns that the rows of one run of a study share."""

    study: str
    scenario: str
    engine: str
    preset: str
    change: str = ""
    options: str = ""
    seed: int = 0
    frames: int = 0

    def row(self, metric: str, value: float | None, note: str = "", bound: float | None = None, status: Status = "info") -> Row:
        """Return the row of one figure."""
        return Row(
            self.scenario, self.engine, self.preset, self.seed, self.frames, metric, value, unit(metric), bound, None, status,
            note, self.study, self.change, self.options,
        )

    def without(self, status: Status, note: str) -> Row:
        """Return the row of a run without figures."""
        return self.row("run", None, note, status=status)
