"""Yardstick of a change that must not change a bit: python -m tests.house.yardstick [-o FILE] [--against FILE] [--filter GLOB].

It writes a line per scene of the catalogue, method and seed, with a hash of every shown state of the short length and of every
count of the frame records, and a line per slice of the fuzz: hostile motion, signed distances of drawn pairs, drawn impacts.
With --against it lists the differences from a file written before, and the exit code is 1 if there are any.
"""

import argparse
import hashlib
import json
import sys
from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from functools import partial
from pathlib import Path

from joblib import Parallel, cpu_count, delayed

from avatarsim.collision.signed_distance import signed_distance
from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError
from avatarsim.simulator import AvatarsimEngine
from scenarios import catalog
from tests.collision.judged import SCRATCH
from tests.collision.strata import BATCH, STRATA, draw
from tests.progress_bar import bar
from tests.rigid.random_impacts import run as impacts
from tests.stability import hostile_run
from tests.stability.hostile import TRIALS

METHODS, SEEDS = ("default", "paper"), (0, 1)
"""Presets of the engine, and seeds of motion and engine."""
FRAMES, IMPACTS, BATCHES = 600, 20_000, 4
"""Length of the slices: frames of hostile motion, impacts, batches of pairs in each stratum."""


def of_scene(name: str, method: str, seed: int) -> str:
    """Return a hash of the states, counts and statuses of a scene at its short length."""
    scenario, engine, found = catalog.get(name).as_run(False), AvatarsimEngine(), hashlib.sha256()
    scene = scenario.build()
    motion = scenario.motion(scene, seed)
    try:
        engine.load(scene, Settings(method, seed=seed), scenario.dt)
        for frame in range(scenario.frames):
            record = engine.advance(motion(frame), scenario.dt)
            found.update(record.state_hash().encode())
            found.update(repr((sorted(record.counts.items()), sorted(record.statuses.items()))).encode())
    except AvatarsimError as error:
        # the hashes before it identify the frame that was refused
        found.update(type(error).__name__.encode())
    finally:
        engine.close()
    return found.hexdigest()


def of_hostile_motion(name: str) -> str:
    """Return a hash of the states and counts of an avatar in hostile motion."""
    report = hostile_run.run(name, seed=1, frames=FRAMES, judge_every=FRAMES)
    return hashlib.sha256(repr((report.hashes, sorted(report.counts.items()))).encode()).hexdigest()


def of_pairs(stratum: str) -> str:
    """Return a hash of the statuses, gaps and points of drawn pairs, to the last bit."""
    found = hashlib.sha256()
    for number in range(BATCHES):
        batch = draw(stratum, 1, number)
        for k in range(BATCH):
            answer = signed_distance(batch.vertices, batch.shapes, 2 * k, 2 * k + 1, (0.0, 0.0, 0.0), SCRATCH)
            found.update(repr(answer).encode())
    return found.hexdigest()


def of_impacts() -> str:
    """Return a hash of the counts and worst figures of drawn impacts."""
    count, worst = impacts(IMPACTS, 1)
    return hashlib.sha256(repr((count, worst.tolist())).encode()).hexdigest()


def slices() -> dict[str, partial[str]]:
    """Return all slices by name."""
    found = {
        f"{name} {method} {seed}": partial(of_scene, name, method, seed)
        for name in catalog.scenarios() for method in METHODS for seed in SEEDS
    }
    found |= {f"hostile {name}": partial(of_hostile_motion, name) for name in TRIALS}
    found |= {f"pairs {stratum}": partial(of_pairs, stratum) for stratum in STRATA}
    return {**found, "impacts": partial(of_impacts)}


def measured(wanted: dict[str, partial[str]], jobs: int) -> dict[str, str]:
    """Return the hash of each slice, with a progress bar."""
    found: Iterator[str] = Parallel(jobs, return_as="generator")(delayed(one)() for one in wanted.values())
    with bar(len(wanted), "slice") as shown:
        hashes = []
        for one in found:
            hashes.append(one)
            shown.update()
    return dict(zip(wanted, hashes, strict=True))


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, write and compare; return 1 if a slice differs or is missing on one side, 2 if no slice matches the filter."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.house.yardstick", description=str(__doc__), formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("-o", "--out", type=Path, metavar="FILE", help="where the hashes go, as JSON (default: the terminal)")
    parser.add_argument("--against", type=Path, metavar="FILE", help="a file written before, to compare with")
    parser.add_argument("--filter", default="*", metavar="GLOB", help="slices whose name matches")
    parser.add_argument("--jobs", type=int, default=cpu_count(), metavar="N", help="slices side by side")
    asked = parser.parse_args(arguments)
    wanted = {name: one for name, one in slices().items() if fnmatchcase(name, asked.filter)}
    if not wanted:
        print(f"no slice is called {asked.filter}", file=sys.stderr)
        return 2
    found = measured(wanted, asked.jobs)
    text = json.dumps(found, indent=1)
    if asked.out:
        asked.out.write_text(f"{text}\n", encoding="utf-8")
    elif not asked.against:
        print(text)
    if not asked.against:
        return 0
    before = {name: told for name, told in json.loads(asked.against.read_text(encoding="utf-8")).items()
              if fnmatchcase(name, asked.filter)}
    other = [name for name in {**before, **found} if before.get(name) != found.get(name)]
    print(f"{len(found)} slices, {len(other)} differ from {asked.against}{''.join(f'{chr(10)}  {name}' for name in other)}")
    return 1 if other else 0


if __name__ == "__main__":
    sys.exit(main())
