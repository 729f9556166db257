"""Doors for command lines: good words of each command, of which some are strange, missing or moved, with damaged files."""

import random
import shutil
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from avatarsim import cli
from avatarsim.cli import pieces
from reports import __main__ as reports
from scenarios import __main__ as scenarios
from tests.clips import made as made_clips
from tests.hostile import valid_files as valid
from tests.hostile.doors import Case, Door, kept_to_one_of, place
from tests.hostile.mutation import damaged

STRANGE = (
    "", " ", "-", "--", "-1", "0", "nan", "inf", "1e400", "9" * 400, "9" * 5000, "*", "[", "[!a", "\x00", "\udcff", "a" * 5000,
    "/dev/null", "no_such_thing", "Ä", "%s", "$(id)", "'", "--help=", "--filter", "--engine", "=", "@file", "1,,2", "é\u202e",
)
"""Words that no user should type; none names a folder of the machine that may be read whole or written to."""

LINES: dict[str, tuple[Callable[[list[str]], int], frozenset[int], tuple[str, ...], str]] = {
    # the filter matches no scene, so that nothing runs even where all words are good ones
    "scenarios": (scenarios.main, frozenset({0, 1, 2, 3, 5}), (
        "run --engine mujoco --preset tuned --seed 7", "compare --settings mine.toml --frames 1", "list", "metrics --json",
        "check --resume earlier", "bench --jobs 0", "study effects --json", "study settings --full", "study", "dance", "-h",
    ), "--filter no_such_* --out out --jobs 0"),
    "reports": (reports.main, frozenset({0, 1, 2}), (
        "diff earlier run", "diff run table.csv", "diff nothing earlier", "baseline run --to made.csv",
    ), ""),
    # one hull, since to decompose takes seconds
    "pieces": (pieces.main, frozenset({0, 2, 3}), (
        "cube.obj --scale 0.1 --threshold 0.1", "cube.stl --seed 3 --most-vertices 16 --json",
        "cube.ply --most-pieces 4 --repair auto",
    ), "--no-cache --quiet --hull"),
    "clips": (cli.main, frozenset({0, 1, 2, 3}), (
        "clean some.bvh --avatar some.bvh --room floor --scale 1 --up y", "tidy some.bvh",
        "clean some.csv --avatar some.xml --quaternion wxyz --fix all", "audit some.bvh --folder . --room some.csv",
        "audit some.csv --avatar some.xml --joints elbow --file-rate 30",
        "audit some.csv --avatar some.xml --keyframe qpos0 --collide collision --fit 0.001 --root fixed",
        "clean some.csv --avatar some.xml --room some.xml --body base --leave a,b --meshes hull --avatar-scale 1",
        "audit some.bvh --home 2", "clean some.bvh --home some.bvh --rate 60", "audit some.bvh --home some.bvh:1 --up y",
        "clean some.bvh --margin 0.002 --blend 0 --rate 60 --loose", "clean some.bvh --room some.xml --asf some.xml --force",
    ), "--workers 0 -o out"),
}
"""Command -> its entry, the exit codes that its help names, good lines, and words that always end a line."""


def files() -> dict[str, bytes]:
    """Return files that the lines name."""
    run = valid.run()["results.json"]
    return {
        **valid.texts()["settings"], "earlier/results.json": run, "run/results.json": run,
        "table.csv": b"scenario,run,metric,unit,value\narm_wall,avatarsim/default,overlap_frames,%,0.5\n",
        **{f"cube.{ending}": valid.meshes(ending)[f"cube.{ending}"] for ending in ("obj", "stl", "ply")},
        "some.xml": made_clips.ROBOT.encode(),
    }


def cases(name: str, seed: int, count: int, folder: Path) -> Iterator[Case]:
    """Yield command lines, each run in this process; names of files are those below the case's folder."""
    main, codes, lines, last = LINES[name]
    whole = {**files(), **{f"some.{end}": make(folder / f"made.{end}", frames=3).read_bytes()
                           for end, make in (("bvh", made_clips.bvh), ("csv", made_clips.csv))}}
    for k in range(count):
        rng = random.Random(f"{seed}/{k}")
        for path, content in whole.items():
            place(folder, path, damaged(content, rng) if rng.random() < 0.3 else content)
        words = rng.choice(lines).split()
        for _ in range(rng.choice((0, 1, 1, 2))):
            at = rng.randrange(len(words) + 1)
            words[at : at + rng.choice((0, 1))] = rng.choice(([], [rng.choice(STRANGE)], [rng.choice(STRANGE)]))
        known = {*whole, "earlier", "run", "nothing", "out", "made.csv", "."}
        words = [str(folder / word) if word in known else word for word in (*words, *last.split())]
        yield Case(repr(words)[:400], partial(asked, main, words, codes))
        shutil.rmtree(folder / "out", ignore_errors=True)


def asked(main: Callable[[list[str]], int], words: list[str], codes: frozenset[int]) -> object:
    """Return the exit code of a command line, one of those that its help names."""
    try:
        code: object = main(words)
    except SystemExit as end:
        # argparse ends the process where words are no options
        code = end.code or 0
    return kept_to_one_of(code, codes)


def doors() -> tuple[Door, ...]:
    """Return the commands that read files."""
    return tuple(Door(f"words of {name}", 1.0 if name == "pieces" else 25.0, partial(cases, name), slow=True) for name in LINES)
