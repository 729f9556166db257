"""`avatarsim compile`: the kernels ahead of their first use, in place or into a folder to carry elsewhere (ahead-of-time cache).

`--to DIR` makes a folder of kernels to carry elsewhere, into a container image or a wheel: see docs/installing.md.
"""

import argparse
import os
from pathlib import Path

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.jit.baseline import compile_for_baseline


def run(args: argparse.Namespace) -> int:
    """Return 0 when everything is compiled; 1 when something could not be. Raises AvatarsimError for impossible options."""
    if args.command is not None and args.to is not None:
        return compile_to(args.to, args.cpu or "baseline")
    from avatarsim.compile_ahead import PARTS, compile_everything, compile_share, is_compiled

    if args.parts is None:
        # without a command this is the first line of other commands, which print more
        if args.command is not None and is_compiled():
            print("the engine's kernels are compiled already: nothing to do")
        return 0 if compile_everything() else 1
    for part in args.parts:
        if part not in PARTS:
            raise UnknownName("part to compile", part, PARTS)
    compile_share(tuple(args.parts))
    # The compiled code is on disk; to take down millions of objects one by one would cost seconds.
    os._exit(0)


def compile_to(folder: Path, cpu: str) -> int:
    """Compile everything for a processor into a folder that all users may read, and return the exit code."""
    if not folder.absolute().parent.is_dir():
        raise InvalidInput("folder of --to", str(folder), "a folder, or the name of one to be made in a folder that exists")
    if cpu == "baseline":
        compile_for_baseline()
    # Imports numba, which reads its settings then.
    from avatarsim.compile_ahead import compile_into

    return 0 if compile_into(folder) else 1
