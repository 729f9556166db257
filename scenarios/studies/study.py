"""Short studies that are part of every comparison: each answers one question about the run and leaves files in its folder.

A study is the short form of a command of its own (`sweep`, `stability`, `ablate`, ...), which asks the same at length.
"""

import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from avatarsim.errors import AvatarsimError, described
from scenarios.job import Outcome
from scenarios.running.timing import Clocked
from scenarios.scenario import Scenario


@dataclass(frozen=True)
class Request:
    """What a study may ask about: `scenarios` by name and `presets` by engine (those that took part and could be opened).

    `folder` is the run's own, `out` that of all runs, in which a store may live; `seed` that of motions and engines; `jobs` how
    many processes may run side by side; `full` asks for full lengths. `outcomes` and `clocked` are what both passes of the run
    gave, by the stem of the job.
    """

    folder: Path
    out: Path
    scenarios: Mapping[str, Scenario]
    presets: Mapping[str, tuple[str, ...]]
    jobs: int
    seed: int
    full: bool
    outcomes: Mapping[str, Outcome] = field(default_factory=dict)
    clocked: Mapping[str, Clocked] = field(default_factory=dict)


@dataclass(frozen=True)
class Study:
    """One question: its `name` in progress lines, and what asks it. `ask` writes its files into the request's folder, whole or
    not at all, and returns a sentence for each thing that it could not do."""

    name: str
    ask: Callable[[Request], Sequence[str]]


def asked_in_turn(studies: Sequence[Study], request: Request) -> list[str]:
    """Ask every study, one after the other: what one of them could not do costs neither the run nor the others.

    Returns a sentence per trouble, each with the name of its study. Raises KeyboardInterrupt when the run is stopped.
    """
    troubles = []
    for study in studies:
        begun = time.monotonic()
        try:
            troubles += [f"{study.name}: {said}" for said in study.ask(request)]
        except AvatarsimError as error:
            troubles.append(f"{study.name}: {error}")
        except Exception as error:
            # a fault in a study must cost neither the verdict nor the report
            troubles.append(f"{study.name}: {described(error)}")
        print(f"{study.name} {time.monotonic() - begun:5.1f} s", file=sys.stderr, flush=True)
    return troubles
