"""Command line: `avatarsim compile`, or `python -m avatarsim`, compiles the kernels ahead of their first use.

`--to DIR` makes a folder of kernels to carry elsewhere, into a container image or a wheel: see docs/installing.md.
"""

import argparse
import os
import sys
from pathlib import Path

from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName
from avatarsim.files import VARIABLE
from avatarsim.jit.baseline import compile_for_baseline


def parsed(arguments: list[str] | None) -> argparse.Namespace:
    """The command line; argparse ends the process if it is wrong."""
    parser = argparse.ArgumentParser(prog="avatarsim", description="Without a command: as `avatarsim compile`.")
    parser.add_argument("--parts", metavar="PART", nargs="+", help="only these parts, in this process")
    commands = parser.add_subparsers(dest="command", title="commands")
    what = "compile the engine's kernels ahead of their first use"
    compiling = commands.add_parser("compile", help=what, description=f"{what.capitalize()}; later starts find them.")
    compiling.add_argument(
        "--to", metavar="DIR", type=Path,
        help=f"make a folder to carry elsewhere: with {VARIABLE} set to it any user starts without compiling, on any machine "
        "with the stated processor",
    )
    compiling.add_argument(
        "--cpu", choices=("baseline", "host"),
        help="with --to: for the stated baseline, x86-64-v3 (the default), or for this very kind of processor",
    )
    found = parser.parse_args(arguments)
    if found.command is not None and found.parts is not None:
        parser.error("--parts goes without a command")
    if found.command is not None and found.cpu is not None and found.to is None:
        parser.error("--cpu goes with --to")
    return found


def main(arguments: list[str] | None = None) -> int:
    """0 when everything is compiled; 1 when something could not be, 2 when what was asked for is impossible."""
    asked = parsed(arguments)
    try:
        if asked.command is not None and asked.to is not None:
            return compile_to(asked.to, asked.cpu or "baseline")
        from avatarsim.compile_ahead import PARTS, compile_everything, compile_share

        if asked.parts is None:
            return 0 if compile_everything() else 1
        for part in asked.parts:
            if part not in PARTS:
                raise UnknownName("part to compile", part, PARTS)
        compile_share(tuple(asked.parts))
    except AvatarsimError as error:
        print(f"avatarsim: {error}", file=sys.stderr)
        return 2
    # What was compiled is on disk; to take down millions of objects one by one would cost seconds.
    os._exit(0)


def compile_to(folder: Path, cpu: str) -> int:
    """Compile everything for a processor into a folder that all users may read; the exit code."""
    if not folder.absolute().parent.is_dir():
        raise InvalidInput("folder of --to", str(folder), "a folder, or the name of one to be made in a folder that exists")
    if cpu == "baseline":
        compile_for_baseline()
    # Imports numba, which reads its settings then.
    from avatarsim.compile_ahead import compile_into

    return 0 if compile_into(folder) else 1


if __name__ == "__main__":
    sys.exit(main())
