"""Doors for command lines: words that no user should type, with files that are damaged or missing."""

import random
import shutil
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from avatarsim import cli
from avatarsim.cli import pieces
from reports import __main__ as reports
from scenarios import __main__ as scenarios
from tests.clips import made as made_clips
from tests.hostile import valid_files as valid
from tests.hostile.doors import Case, Door, kept_to_one_of, place
from tests.hostile.mutation import damaged, damaged_csv, damaged_json

CODES = {"scenarios": frozenset({0, 1, 2, 3, 5}), "reports": frozenset({0, 1, 2}), "pieces": frozenset({0, 2, 3}),
         "clips": frozenset({0, 1, 2, 3})}
"""What each command's help says of its exit codes."""
STRANGE = (
    "", " ", "-", "--", "-1", "0", "nan", "inf", "1e400", "9" * 400, "9" * 5000, "*", "[", "[!a", "\x00", "\udcff", "a" * 5000,
    "..", "/", "/dev/null", "no_such_thing", "Ä", "%s", "$(id)", "'", "--help=", "--filter", "--engine", "=",
    "@file", "1,,2", "é\u202e",
)
"""Words."""
COMMANDS = ("list", "metrics", "run", "compare", "check", "bench", "ablate", "sweep", "stability", "dance", "", "-h", "list")


def word(rng: random.Random, *good: str) -> str:
    """One of the good words, more often than a strange one."""
    return rng.choice(good) if good and rng.random() < 0.6 else rng.choice(STRANGE)


def of_scenarios(rng: random.Random, folder: Path) -> list[str]:
    """A command of the harness. Its filter matches no scene, so that nothing runs even where all words are good ones."""
    settings = place(folder, "mine.toml", damaged(valid.texts()["settings"]["mine.toml"], rng))
    words = [rng.choice(COMMANDS)]
    options: Sequence[tuple[str, Callable[[], str]]] = (
        ("--engine", lambda: word(rng, "avatarsim", "mujoco")), ("--preset", lambda: word(rng, "default", "tuned")),
        ("--seed", lambda: word(rng, "0", "7")), ("--settings", lambda: word(rng, str(settings), str(folder))),
        ("--jobs", lambda: word(rng, "0")), ("--resume", lambda: word(rng, str(folder / "earlier"), str(folder))),
        ("--frames", lambda: word(rng, "1")), ("--effects", lambda: ""), ("--json", lambda: ""), ("--full", lambda: ""),
    )
    for option, value in rng.sample(options, rng.randrange(5)):
        words += [option, value()] if rng.random() < 0.9 else [option]
    if rng.random() < 0.2:
        words.insert(rng.randrange(len(words) + 1), rng.choice(STRANGE))
    # last, so that they hold whatever stands before them
    return [*words, "--filter", "no_such_*", "--out", str(folder / "out"), "--jobs", "0"]


def of_reports(rng: random.Random, folder: Path) -> list[str]:
    """A comparison of runs, damaged or not; nothing that writes into the checkout."""
    damaged_run(rng, folder)
    places = (str(folder / "earlier"), str(folder / "run"), str(folder / "table.csv"), str(folder / "nothing"), str(folder))
    kind = rng.random()
    if kind < 0.2:
        return ["baseline", word(rng, *places), "--to", str(folder / "made.csv")]
    words = ["diff", word(rng, *places), word(rng, *places)]
    if kind > 0.85:
        words.insert(rng.randrange(3), rng.choice(STRANGE))
    return words


def damaged_run(rng: random.Random, folder: Path) -> None:
    """Damage one of the two runs and the table, or none of them."""
    content = valid.run()["results.json"]
    for name in ("earlier/results.json", "run/results.json"):
        place(folder, name, damaged_json(content, rng) if rng.random() < 0.4 else content)
    table = b"scenario,run,metric,unit,value\narm_wall,avatarsim/default,overlap_frames,%,0.5\n"
    place(folder, "table.csv", damaged_csv(table, rng) if rng.random() < 0.5 else table)


def of_pieces(rng: random.Random, folder: Path) -> list[str]:
    """Meshes, damaged or not, and all options; one hull, since to decompose takes seconds."""
    ending = rng.choice(("obj", "stl", "ply", "off"))
    content = valid.meshes(ending)[f"cube.{ending}"]
    mesh = place(folder, f"some.{ending}", damaged(content, rng) if rng.random() < 0.5 else content)
    words = ["--no-cache", "--quiet", "--hull", word(rng, str(mesh), str(mesh), str(folder))]
    options = (("--scale", "0.1"), ("--threshold", "0.1"), ("--seed", "3"), ("--most-vertices", "16"), ("--most-pieces", "4"),
               ("--repair", "auto"))
    for option, good in rng.sample(options, rng.randrange(4)):
        words += [option, word(rng, good)]
    return [*words, "--json"] if rng.random() < 0.3 else words


def of_clips(rng: random.Random, folder: Path) -> list[str]:
    """Clips, models and rooms, damaged or not, and all options; no folder but that of the case is read or written."""

    def file(name: str, content: bytes) -> str:
        return str(place(folder, name, damaged(content, rng) if rng.random() < 0.4 else content))

    recorded = file("some.bvh", made_clips.bvh(folder / "whole.bvh", frames=3).read_bytes())
    table = file("some.csv", made_clips.csv(folder / "whole.csv", frames=3).read_bytes())
    model = file("some.xml", made_clips.ROBOT.encode())
    options: Sequence[tuple[str, Callable[[], str]]] = (
        ("--avatar", lambda: word(rng, model, recorded)), ("--room", lambda: word(rng, "floor", model, table)),
        ("--scale", lambda: word(rng, "1", "0.01")), ("--up", lambda: word(rng, "y", "z")),
        ("--rate", lambda: word(rng, "30", "60")), ("--asf", lambda: word(rng, model)),
        ("--file-rate", lambda: word(rng, "30")), ("--margin", lambda: word(rng, "0.002")), ("--blend", lambda: word(rng, "0")),
        ("--fix", lambda: word(rng, "all", "elbow")), ("--quaternion", lambda: word(rng, "wxyz")),
        ("--joints", lambda: word(rng, "elbow")), ("--folder", lambda: word(rng, str(folder))), ("--loose", lambda: ""),
        ("--force", lambda: ""), ("--no-page", lambda: ""), ("--workers", lambda: word(rng, "0")),
    )
    strange = [one for one in STRANGE if one not in ("..", "/")]
    motion = rng.choice([recorded, table]) if rng.random() < 0.8 else rng.choice(strange)
    words = [rng.choice(("clean", "clean", "audit", "tidy")), motion]
    for option, value in rng.sample(options, rng.randrange(5)):
        # a number or a word of its own, never a folder of the machine
        said = value()
        words += [option] if said == "" else [option, said if said not in ("..", "/") else "elsewhere"]
    # last, so that they hold whatever stands before them
    return [*words, "--workers", "0", "-o", str(folder / "out")]


def cases(made: Callable[[random.Random, Path], list[str]], main: Callable[[list[str]], int], codes: frozenset[int], seed: int,
          count: int, folder: Path) -> Iterator[Case]:
    """Command lines, each asked in this process."""
    for k in range(count):
        rng = random.Random(f"{seed}/{k}")
        words = made(rng, folder)
        told = " ".join(repr(one) if len(one) < 60 else f"{one[:20]!r}..." for one in words)
        yield Case(told, partial(asked, main, words, codes))
        shutil.rmtree(folder / "out", ignore_errors=True)


def asked(main: Callable[[list[str]], int], words: list[str], codes: frozenset[int]) -> object:
    """The exit code of a command line, one of those that its help names."""
    try:
        code: object = main(words)
    except SystemExit as end:
        # argparse ends the process where words are no options
        code = end.code or 0
    return kept_to_one_of(code, codes)


def doors() -> tuple[Door, ...]:
    """The commands that read files."""
    return tuple(
        Door(f"words of {name}", weight, partial(cases, made, main, CODES[name]), slow=True)
        for name, weight, made, main in (
            ("scenarios", 25.0, of_scenarios, scenarios.main), ("reports", 25.0, of_reports, reports.main),
            ("pieces", 1.0, of_pieces, pieces.main), ("clips", 25.0, of_clips, cli.main),
        )
    )
