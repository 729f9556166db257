"""`python -m benchmarks NAME [--run FOLDER] [--quick]`: measure, write CSV files into a run's folder, print tables."""

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module

from avatarsim.cleaning import Options
from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError
from runfiles.files import OUT, last_comparison
from runfiles.naming import GATED

COMMANDS = {
    "narrow-phase": ("narrow_phase.measure", "time and error of one signed-distance query, five libraries"),
    "broad-phase": ("broad_phase", "time per object of the sweep, 20 to 20,000 objects"),
    "growth": ("growth", "frame time against links, avatars and objects"),
    "first-frame": ("first_frame", "the first frame after load against the median frame; 1: one is long"),
    "table-2": ("table_2", "Table 2, Figures 7 and 8 of the paper, from a run with times; 5: it has none of the scenes"),
    "cleaning": ("cleaning", "recorded clips made free of overlap, before and after; 1: a promise is broken"),
}
"""Module and answer of each command."""


def parser() -> argparse.ArgumentParser:
    """Return all commands and their options."""
    made = argparse.ArgumentParser(
        prog="python -m benchmarks", description="Measure, write CSV files into a run's folder, print tables.",
        epilog="Exit codes: 0 done, 2 usage or a file that cannot be used, 3 something could not be measured.",
    )
    commands = made.add_subparsers(dest="name", required=True, metavar="NAME")
    by_name = {name: commands.add_parser(name, help=what, description=what) for name, (_, what) in COMMANDS.items()}
    for one in by_name.values():
        one.add_argument("--run", type=path_option, metavar="FOLDER", help="folder of the files (default: the last comparison)")
        one.add_argument("--quick", action="store_true", help="the smallest size: shows that it runs, times mean nothing")
    by_name["narrow-phase"].add_argument("--cells", default="*", metavar="GLOB", help='such as "box-*" or "* deep"')
    by_name["growth"].add_argument("--engine", nargs="+", metavar="NAME", help="engines (default: all)")
    first = by_name["first-frame"]
    first.add_argument("--filter", default="*", metavar="GLOB", help="scenes whose name matches (default: all)")
    first.add_argument("--preset", nargs="+", default=[GATED[1]], metavar="NAME", help=f"presets (default: {GATED[1]})")
    by_name["table-2"].add_argument("--of", type=path_option, metavar="RUN", help="a run with times (default: --run)")
    cleaning = by_name["cleaning"]
    cleaning.add_argument("--clips", nargs="+", metavar="NAME", help="these clips only")
    cleaning.add_argument("--rooms", nargs="+", metavar="ROOM", help="floor, gallery (default: both)")
    cleaning.add_argument("--margin", type=float, default=Options().margin, help="gap that is kept [m]")
    cleaning.add_argument("--blend", type=float, default=Options().blend, help="how long limbs give way before contact [s]")
    return made


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command."""
    arguments = parser().parse_args(argv)
    module, _ = COMMANDS[arguments.name]
    try:
        code: int = import_module(f"benchmarks.{module}").run(arguments, arguments.run or last_comparison(OUT, "benchmarks"))
    except (AvatarsimError, OSError) as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    return code


if __name__ == "__main__":
    sys.exit(ended(main))
