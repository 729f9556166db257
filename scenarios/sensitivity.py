"""Sensitivity of the posture solver to its tuned numbers: each a fifth less and more, one at a time, on motions drawn afresh
(one-at-a-time analysis; Saltelli and others 2008, chapter 2).

A number whose change moves no figure by more than chance is not needed: it is derived from another, or goes. What chance
does is told by a change of a millionth, after which hostile motion takes another course all the same.
"""

import argparse
import ast
import csv
import math
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from avatarsim.console import ended
from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName
from scenarios.posture_table.plan import drawn_seed
from scenarios.running.progress import Progress

ROOT = Path(__file__).resolve().parents[1]

ROOMS = ("avatarsim/ik", "avatarsim/planner", "avatarsim/coupling")
"""Rooms whose constants are looked at, as far as they are there."""

SETTINGS, GROUP = "avatarsim/settings.py", "PostureSettings"
"""File and class of the settings that are looked at."""

SHARES = (0.8, 1.2)
"""A fifth less and more: the scatter of one number tuned twice by hand."""

CHANCE = 1.0 + 1e-6
"""Factor of the change that tells what chance does."""

COPIED = ("avatarsim", "runfiles", "scenarios", "reference", "reports", "pyproject.toml")
"""What a run needs of the project."""

FIGURES = ("chatter", "jerk_ratio", "turn_max", "root_max", "offset_p50", "offset_p95", "angle_p50", "angle_p95", "time_p50",
           "far")
"""Columns of the posture table that are compared."""


class Number(NamedTuple):
    """A tuned number: file, name, value, and where it stands in the file: line, first and last column (from 0)."""

    path: str
    name: str
    value: float
    line: int
    first: int
    last: int

    @property
    def whole(self) -> bool:
        """Whether it counts something."""
        return isinstance(self.value, int)


def numbers() -> list[Number]:
    """All tuned numbers, in order: settings, then constants by file."""
    found = list(_settings(ROOT / SETTINGS))
    for room in ROOMS:
        for path in sorted((ROOT / room).glob("*.py")):
            found += _constants(path)
    return found


def _settings(path: Path) -> Iterator[Number]:
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef) and node.name == GROUP:
            for field in node.body:
                if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and field.value is not None:
                    yield from _number(path, field.target.id, field.value)


def _constants(path: Path) -> Iterator[Number]:
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if not isinstance(node, ast.Assign):
            continue
        target = node.targets[0]
        pairs = [(target, node.value)]
        if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
            pairs = list(zip(target.elts, node.value.elts, strict=True))
        for name, value in pairs:
            if isinstance(name, ast.Name) and name.id.isupper():
                yield from _number(path, name.id, value)


def _number(path: Path, name: str, value: ast.expr) -> Iterator[Number]:
    if isinstance(value, ast.Constant) and isinstance(value.value, int | float) and not isinstance(value.value, bool):
        place = path.relative_to(ROOT).as_posix()
        yield Number(place, name, value.value, value.lineno - 1, value.col_offset, value.end_col_offset or value.col_offset)


def changed(number: Number, share: float) -> float:
    """The number times `share`; of one that counts the nearest other whole number in that direction."""
    if not number.whole:
        return number.value * share
    nearest = round(number.value * share)
    return nearest if nearest != number.value else int(number.value) + int(math.copysign(1, share - 1.0))


def write_changed(folder: Path, number: Number, value: float) -> None:
    """Put `value` in the place of a number, in a copy of the project."""
    path = folder / number.path
    lines = path.read_text(encoding="utf-8").split("\n")
    line = lines[number.line]
    lines[number.line] = f"{line[: number.first]}{value!r}{line[number.last :]}"
    path.write_text("\n".join(lines), encoding="utf-8")


def measured(change: tuple[Number, float] | None, words: Sequence[str], kernels: Path) -> dict[str, float]:
    """Figures, each the mean over the rooms, of the project with one number changed; AvatarsimError if it does not run. Compiled
    kernels are kept in the folder `kernels`: those that do not depend on the number are compiled once for all."""
    with tempfile.TemporaryDirectory(prefix="sensitivity-") as made:
        folder = Path(made)
        for name in COPIED:
            source = ROOT / name
            if source.is_dir():
                skipped = shutil.ignore_patterns("__pycache__", "out")
                shutil.copytree(source, folder / name, ignore=skipped)
            else:
                shutil.copy(source, folder / name)
        if change is not None:
            write_changed(folder, *change)
        table = folder / "table.csv"
        command = [sys.executable, "-m", "scenarios.posture_table", "--rivals", "--groups", "rooms", "-o", str(table)]
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(kernels)}
        run = subprocess.run([*command, *words], cwd=folder, env=environment, capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise AvatarsimError((run.stderr.strip().splitlines() or ["it ended without a word"])[-1])
        rows = list(csv.DictReader(table.read_text(encoding="utf-8").splitlines()))
    return {name: sum(float(row[name]) for row in rows) / len(rows) for name in FIGURES}


def told(figures: Mapping[str, float], base: Mapping[str, float]) -> str:
    """Cells of a row: how much each figure changed [%]."""
    cells = [
        f"{100.0 * (figures[name] - base[name]) / base[name]:+.0f}" if base[name] else f"{figures[name]:.3g}" for name in FIGURES
    ]
    return " | ".join(cells)


def main(arguments: Sequence[str] | None = None) -> int:
    """The table on the screen; 2 if a number was asked for that is not there."""
    about = (__doc__ or "").partition("\n\n")[0]
    parser = argparse.ArgumentParser(prog="python -m scenarios.sensitivity", description=about)
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="these numbers (default: all)")
    parser.add_argument("--list", action="store_true", help="only say which numbers there are")
    parser.add_argument("--seeds", type=int, default=4, metavar="N", help="motions drawn in each room")
    parser.add_argument("--seed", type=int, metavar="K", help="seed of the first (default: drawn for this run)")
    asked = parser.parse_args(arguments)
    found = numbers()
    try:
        unknown = [name for name in asked.only if name not in {number.name for number in found}]
        if unknown:
            raise UnknownName("tuned number", unknown[0], sorted({number.name for number in found}))
        if asked.seeds < 1:
            raise InvalidInput("--seeds", asked.seeds, "a whole number from 1")
    except AvatarsimError as error:
        print(f"avatarsim: {error}", file=sys.stderr)
        return 2
    chosen = [number for number in found if not asked.only or number.name in asked.only]
    if asked.list:
        for number in chosen:
            print(f"{number.path:40s} {number.name:24s} {number.value:g}")
        print(f"{len(chosen)} numbers, {sum(number.path == SETTINGS for number in chosen)} of them settings")
        return 0
    seed = asked.seed if asked.seed is not None else drawn_seed()
    print(f"seed {seed}, {asked.seeds} motions in each room; changes in %, of the mean over the rooms", flush=True)
    _print_table(chosen, found, ["--seeds", str(asked.seeds), "--seed", str(seed), "--repeats", "1", "--jobs", "1"])
    return 0


def _print_table(chosen: Sequence[Number], found: Sequence[Number], words: Sequence[str]) -> None:
    """A row per number and direction, written as it is known."""
    jiggled = next(number for number in found if not number.whole)
    kept = tempfile.TemporaryDirectory(prefix="sensitivity-")
    with kept as kernels, Progress("sensitivity", 2 + 2 * len(chosen), sys.stderr) as progress:
        base = measured(None, words, Path(kernels))
        progress.step("as it is")
        print(f"| number | value | {' | '.join(FIGURES)} |\n|{'---|' * (len(FIGURES) + 2)}")
        print(f"| as it is | | {' | '.join(f'{base[name]:.3g}' for name in FIGURES)} |")
        print(f"| chance | | {told(measured((jiggled, jiggled.value * CHANCE), words, Path(kernels)), base)} |", flush=True)
        progress.step("chance")
        for number in chosen:
            for share in SHARES:
                value = changed(number, share)
                try:
                    cells = told(measured((number, value), words, Path(kernels)), base)
                except AvatarsimError as error:
                    cells = f"does not run: {error}"
                print(f"| {number.name} | {number.value:g} to {value:g} | {cells} |", flush=True)
                progress.step(f"{number.name} {value:g}")


if __name__ == "__main__":
    sys.exit(ended(main))
